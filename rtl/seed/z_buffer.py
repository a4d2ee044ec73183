# SPDX-License-Identifier: MIT
"""The nearest hit so far."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import bit, position_bits, unsigned


@block
def z_buffer(
    clk, steps, offered, colour, hit, depth, point, found, found_axis, found_colour, found_mirror, found_point,
    config: Configuration,
):  # fmt: skip
    """Keep what is offered at steps.write_z_buf if it is a hit, and nearer than what is kept.

    colour: of offered at the point, 24 bits; depth: unsigned, position_bits; point: an `Origin`. Of two hits at one
    depth the first stays, which is the lower rectangle: rectangles come in order. found: anything was hit since
    steps.reset_z_buf; found_axis, found_colour, found_point and found_mirror, which is None without config.materials:
    of the nearest, from the cycle after its write.
    """
    nearest = unsigned(position_bits(config))
    nearer = bit()

    @always_comb
    def compare():
        nearer.next = hit and ((not found) or (depth < nearest))

    @always(clk.posedge)
    def keep():
        if steps.reset_z_buf:
            found.next = False
        elif steps.write_z_buf and nearer:
            found.next = True
            nearest.next = depth
            found_axis.next = offered.axis
            found_colour.next = colour
            found_point.word.next = point.word

    if config.materials:

        @always(clk.posedge)
        def keep_mirror():
            if steps.write_z_buf and nearer and not steps.reset_z_buf:
                found_mirror.next = offered.mirror

    return instances()
