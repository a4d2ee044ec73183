# SPDX-License-Identifier: MIT
"""The nearest hit so far."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import position_bits


@block
def z_buffer(
    clk, steps, offered, colour, hit, depth, point, found, found_axis, found_colour, found_mirror, found_point,
    config: Configuration,
):  # fmt: skip
    """Keep the nearest hit: at steps.write_z_buf, take the offered hit if it is nearer than the stored one.

    At equal depth the first hit stays, which is the lower rectangle, as rectangles come in order. The found_ outputs
    describe the nearest hit, from the cycle after its write.

    Args:
        steps: `Steps`; only reset_z_buf and write_z_buf are read. reset_z_buf has priority.
        offered: `Rect` of the offered hit; read with steps.write_z_buf.
        colour: unsigned, 24 bits; the colour of offered at point, read with steps.write_z_buf.
        hit: flag; the ray hits offered. Read with steps.write_z_buf.
        depth: unsigned, `position_bits` bits; the depth of the hit, read with steps.write_z_buf.
        point: `Origin`; the hit point, read with steps.write_z_buf.
        found: output flag; something was hit since steps.reset_z_buf.
        found_axis: unsigned output, 2 bits; the axis of the nearest hit's plane, 0, 1, 2 for x, y, z.
        found_colour: unsigned output, 24 bits; the colour of the nearest hit.
        found_mirror: unsigned output, 3 bits; the share that the rectangle of the nearest hit mirrors, 0 to 4 quarters.
            Driven with `config.materials`.
        found_point: output `Origin`; the nearest hit point.
    """
    nearest = unsigned(position_bits(config))
    nearer = bit()

    compare = assign(nearer, lambda: hit and ((not found) or (depth < nearest)))

    @always(clk.posedge)
    def keep():
        if steps.reset_z_buf:
            found.next = False
        elif steps.write_z_buf and nearer:
            found.next = True
            nearest.next, found_axis.next, found_colour.next = depth, offered.axis, colour
            found_point.word.next = point.word

    if offered.has("mirror"):
        keep_mirror = register(
            clk, found_mirror, lambda: offered.mirror, steps.write_z_buf and nearer and not steps.reset_z_buf
        )

    return instances()
