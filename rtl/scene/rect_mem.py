# SPDX-License-Identifier: MIT
"""The world's rectangles."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.registers import register_map
from raycaster.rtl.common.legacy import ParallelRects, PipelinedRects, Rect
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit, index_bits, side_by_side, signed, unsigned
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.rect_sorter import rect_sorter


@block
def rect_mem(clk, reset, bus, read_word, bad_rectangle, rects, config: Configuration):
    """config.rectangles slots, and the view of the live ones that the engine asks for.

    read_word: the shadow's word at bus.address, combinational, 0 where there is none. bad_rectangle: the shadow holds
    an enabled rectangle without a plane. rects: Sequential-, Pipelined- or ParallelRects.
    """
    count = config.rectangles
    table_slot = register_map(1)["rectangle[0].corner_0"].address // 4
    address_width = len(bus.address)
    index_width = index_bits(config)

    numbers = [tied(table_slot + number, address_width - 2) for number in range(count)]
    corners_0, corners_1, surfaces = ([unsigned(WORD_BITS) for _ in range(count)] for _ in range(3))
    live_corners_0, live_corners_1, live_surfaces = ([unsigned(WORD_BITS) for _ in range(count)] for _ in range(3))
    usables, bads = ([bit() for _ in range(count)] for _ in range(2))
    usable = side_by_side(usables)
    bad = side_by_side(bads)
    read_slot = signed(address_width - 1)
    read_index = unsigned(index_width)
    in_table = bit()

    slots = [
        rect_slot(
            clk, reset, bus, numbers[i], corners_0[i], corners_1[i], surfaces[i],
            live_corners_0[i], live_corners_1[i], live_surfaces[i], usables[i], bads[i],
        )
        for i in range(count)
    ]  # fmt: skip

    # Which rectangle software reads; the table starts after the other registers.
    @always_comb
    def locate():
        read_slot.next = bus.address[address_width:2] - table_slot

    # An index that is out of the table reads nothing, and must not reach beyond the list.
    @always_comb
    def clip():
        in_table.next = (read_slot >= 0) and (read_slot < count)
        read_index.next = 0
        if (read_slot >= 0) and (read_slot < count):
            read_index.next = read_slot[index_width:]

    # Its word, and 0 outside the table and in the unused word of each slot.
    @always_comb
    def read():
        read_word.next = 0
        if in_table:
            if bus.address[2:] == 0:
                read_word.next = corners_0[read_index]
            elif bus.address[2:] == 1:
                read_word.next = corners_1[read_index]
            elif bus.address[2:] == 2:
                read_word.next = surfaces[read_index]

    # One bad rectangle is enough.
    @always_comb
    def judge():
        bad_rectangle.next = bad != 0

    # The engine skips what it cannot use.
    @always_comb
    def show_usable():
        rects.usable.next = usable

    common = slots, locate, clip, read, judge, show_usable

    if isinstance(rects, ParallelRects):
        all_corners_0, all_corners_1, all_surfaces = map(side_by_side, (live_corners_0, live_corners_1, live_surfaces))

        # Everything at once.
        @always_comb
        def show_all():
            rects.corner_0.next = all_corners_0
            rects.corner_1.next = all_corners_1
            rects.surface.next = all_surfaces

        return common, show_all

    chosen_corner_0, chosen_corner_1, chosen_surface = (unsigned(WORD_BITS) for _ in range(3))
    sorted_rect = Rect()
    sorter = rect_sorter(chosen_corner_0, chosen_corner_1, chosen_surface, sorted_rect)

    if isinstance(rects, PipelinedRects):
        # Held until the next one is asked for.
        @always(clk.posedge)
        def choose_and_hold():
            if rects.fetch:
                chosen_corner_0.next = live_corners_0[rects.index]
                chosen_corner_1.next = live_corners_1[rects.index]
                chosen_surface.next = live_surfaces[rects.index]

        # Sorted a cycle later.
        @always(clk.posedge)
        def present_each():
            rects.rect.axis.next = sorted_rect.axis
            rects.rect.position.next = sorted_rect.position
            rects.rect.u_low.next = sorted_rect.u_low
            rects.rect.u_high.next = sorted_rect.u_high
            rects.rect.v_low.next = sorted_rect.v_low
            rects.rect.v_high.next = sorted_rect.v_high
            rects.rect.colour.next = sorted_rect.colour

        return common, sorter, choose_and_hold, present_each

    # The rectangle that is asked for.
    @always_comb
    def choose():
        chosen_corner_0.next = live_corners_0[rects.index]
        chosen_corner_1.next = live_corners_1[rects.index]
        chosen_surface.next = live_surfaces[rects.index]

    # Held until the next one is asked for.
    @always(clk.posedge)
    def present():
        if rects.fetch:
            rects.rect.axis.next = sorted_rect.axis
            rects.rect.position.next = sorted_rect.position
            rects.rect.u_low.next = sorted_rect.u_low
            rects.rect.u_high.next = sorted_rect.u_high
            rects.rect.v_low.next = sorted_rect.v_low
            rects.rect.v_high.next = sorted_rect.v_high
            rects.rect.colour.next = sorted_rect.colour

    return common, sorter, choose, present
