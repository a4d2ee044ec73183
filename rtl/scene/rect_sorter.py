# SPDX-License-Identifier: MIT
"""A rectangle as it was written becomes a rectangle as the engine wants it."""

from myhdl import always_comb, block, concat, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.rtl.common.widths import AXIS_BITS, CELL_BITS, KIND_BITS, MIRROR_BITS, RGB_BITS, side_by_side, unsigned
from raycaster.scene import CELLS


@block
def rect_sorter(written, rect, config: Configuration):
    """Find the axis (the first coordinate that both corners share) and put the bounds in order. Combinational.

    written: WrittenRect; the corners may come in any order, and more mirror than there is counts as all. rect: Rect;
    don't care without a plane.
    """
    looks, cells = [], len(CELLS)
    axis = unsigned(AXIS_BITS)
    position, u_0, u_1, v_0, v_1, u_low, u_high, v_low, v_high = (unsigned(COORDINATE_BITS) for _ in range(9))

    # The two other axes come in the order x, y, z.
    @always_comb
    def find_axis():
        axis.next = 2
        position.next = written.z_0
        u_0.next = written.x_0
        u_1.next = written.x_1
        v_0.next = written.y_0
        v_1.next = written.y_1
        if written.x_0 == written.x_1:
            axis.next = 0
            position.next = written.x_0
            u_0.next = written.y_0
            u_1.next = written.y_1
            v_0.next = written.z_0
            v_1.next = written.z_1
        elif written.y_0 == written.y_1:
            axis.next = 1
            position.next = written.y_0
            v_0.next = written.z_0
            v_1.next = written.z_1

    @always_comb
    def sort_u():
        u_low.next = u_0
        u_high.next = u_1
        if u_0 > u_1:
            u_low.next = u_1
            u_high.next = u_0

    @always_comb
    def sort_v():
        v_low.next = v_0
        v_high.next = v_1
        if v_0 > v_1:
            v_low.next = v_1
            v_high.next = v_0

    if config.materials:
        mirror = unsigned(MIRROR_BITS)
        looks.append(mirror)

        @always_comb
        def limit_mirror():
            mirror.next = written.mirror
            if written.mirror > 4:
                mirror.next = 4

    if config.patterns:
        kind = unsigned(KIND_BITS)
        pattern = unsigned(KIND_BITS + CELL_BITS + RGB_BITS)
        looks.append(pattern)

        # A cell as large as the world leaves nothing odd.
        @always_comb
        def drop_large_cells():
            kind.next = written.kind
            if written.cell >= cells:
                kind.next = 0

        @always_comb
        def take_pattern():
            pattern.next = concat(kind, written.cell, written.colour_2)

    if looks:
        look = side_by_side(looks[::-1])

        @always_comb
        def join():
            rect.word.next = concat(axis, position, written.colour, look, u_low, u_high, v_low, v_high)

    else:

        @always_comb
        def join():
            rect.word.next = concat(axis, position, written.colour, u_low, u_high, v_low, v_high)

    return instances()
