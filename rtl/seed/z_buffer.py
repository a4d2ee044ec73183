# SPDX-License-Identifier: MIT
"""The nearest hit so far."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import bit, position_bits, unsigned


@block
def z_buffer(
    clk, steps, finishing_rect, hit, depth, point, found, found_axis, found_colour, found_point, config: Configuration
):
    """Keep what is offered at steps.write_z_buf if it is a hit, and nearer than what is kept.

    Of two hits at one depth the first stays, which is the lower rectangle: rectangles come in order. found: anything
    was hit since steps.reset_z_buf; the other outputs then tell what, from the cycle after the write.
    """
    nearest = unsigned(position_bits(config))
    nearer = bit()

    # Strictly nearer, or the first.
    @always_comb
    def compare():
        nearer.next = hit and ((not found) or (depth < nearest))

    # Reset marks the buffer empty; a write replaces it.
    @always(clk.posedge)
    def keep():
        if steps.reset_z_buf:
            found.next = False
        elif steps.write_z_buf and nearer:
            found.next = True
            nearest.next = depth
            found_axis.next = finishing_rect.axis
            found_colour.next = finishing_rect.colour
            found_point.x.next = point.x
            found_point.y.next = point.y
            found_point.z.next = point.z

    return compare, keep
