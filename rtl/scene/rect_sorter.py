# SPDX-License-Identifier: MIT
"""The conversion of a rectangle from its written form to the engine's form."""

from myhdl import always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import AXIS_BITS, KIND_BITS, MIRROR_BITS
from raycaster.scene import CELLS


@block
def rect_sorter(written, rect):
    """Find a rectangle's axis (the first coordinate that both corners share) and order its bounds. Combinational.

    Args:
        written: `WrittenRect`; the corners may come in any order, a mirror of more than 4 quarters counts as 4, and a
            pattern whose cell is at least as large as the world counts as plain.
        rect: `Rect`; output, don't care if the rectangle has no plane.
    """
    cells = len(CELLS)
    axis, mirror, kind = unsigned(AXIS_BITS), unsigned(MIRROR_BITS), unsigned(KIND_BITS)
    position, x_low, x_high, y_low, y_high, z_low, z_high = (unsigned(COORDINATE_BITS) for _ in range(7))
    u_low, u_high, v_low, v_high = (unsigned(COORDINATE_BITS) for _ in range(4))

    @always_comb
    def find_axis():
        axis.next = 2
        position.next = written.z_0
        if written.x_0 == written.x_1:
            axis.next = 0
            position.next = written.x_0
        elif written.y_0 == written.y_1:
            axis.next = 1
            position.next = written.y_0

    # All three pairs are sorted at the same time: sorting only those of the other two axes would take longer.
    sort_x_low = assign(x_low, lambda: written.x_1 if written.x_0 > written.x_1 else written.x_0)
    sort_x_high = assign(x_high, lambda: written.x_0 if written.x_0 > written.x_1 else written.x_1)
    sort_y_low = assign(y_low, lambda: written.y_1 if written.y_0 > written.y_1 else written.y_0)
    sort_y_high = assign(y_high, lambda: written.y_0 if written.y_0 > written.y_1 else written.y_1)
    sort_z_low = assign(z_low, lambda: written.z_1 if written.z_0 > written.z_1 else written.z_0)
    sort_z_high = assign(z_high, lambda: written.z_0 if written.z_0 > written.z_1 else written.z_1)

    # u and v are the other two axes, in the order x, y, z.
    choose_u_low = assign(u_low, lambda: y_low if axis == 0 else x_low)
    choose_u_high = assign(u_high, lambda: y_high if axis == 0 else x_high)
    choose_v_low = assign(v_low, lambda: y_low if axis == 2 else z_low)
    choose_v_high = assign(v_high, lambda: y_high if axis == 2 else z_high)

    if rect.has("mirror"):
        limit_mirror = assign(mirror, lambda: 4 if written.mirror > 4 else written.mirror)

    if rect.has("kind"):
        # With a cell as large as the world, no cell is odd.
        drop_large_cells = assign(kind, lambda: 0 if written.cell >= cells else written.kind)

    whole = rect.joined(
        axis=axis, position=position, colour=written.colour, mirror=mirror, kind=kind, cell=written.cell,
        colour_2=written.colour_2, u_low=u_low, u_high=u_high, v_low=v_low, v_high=v_high,
    )  # fmt: skip

    join = assign(rect.word, lambda: whole)

    return instances()
