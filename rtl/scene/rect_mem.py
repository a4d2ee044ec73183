# SPDX-License-Identifier: MIT
"""The world's rectangles."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.records import rect_of
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit, index_bits, side_by_side, signed, unsigned
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.written_rect import CORNER, written_of


@block
def rect_mem(clk, reset, bus, readback, bad_rectangle, rects, config: Configuration):
    """config.rectangles slots, and the live rectangle that the engine asks for; rects: Rects.

    readback: the shadow's word at bus.address, 32 bits, combinational, 0 where there is none. bad_rectangle: the shadow
    holds an enabled rectangle without a plane.
    """
    count = config.rectangles
    table_slot = CORNER.address // 4
    address_width = len(bus.address)
    index_width = index_bits(config)

    numbers = [tied(table_slot + number, address_width - 2) for number in range(count)]
    shadows, lives = ([written_of(config) for _ in range(count)] for _ in range(2))
    shadow_words, live_words = ([written.word for written in stage] for stage in (shadows, lives))
    usables, bads = ([bit() for _ in range(count)] for _ in range(2))
    usable, bad = side_by_side(usables), side_by_side(bads)
    read_slot = signed(address_width - 1)
    read_index = unsigned(index_width)
    in_table = bit()
    read, chosen = written_of(config), written_of(config)
    pattern_word = read.pattern if config.patterns else tied(0, WORD_BITS)
    sorted_rect = rect_of(config)

    slots = [
        rect_slot(
            clk, reset, bus, numbers[i], shadow=shadows[i], live=lives[i], usable=usables[i], bad=bads[i], config=config
        )
        for i in range(count)
    ]
    sorter = rect_sorter(chosen, sorted_rect, config)

    # The table starts after the other registers.
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

    @always_comb
    def read_rect():
        read.word.next = shadow_words[read_index]

    # 0 outside the table.
    @always_comb
    def read_word():
        readback.next = 0
        if in_table:
            if bus.address[2:] == 0:
                readback.next = read.corner_0
            elif bus.address[2:] == 1:
                readback.next = read.corner_1
            elif bus.address[2:] == 2:
                readback.next = read.surface
            else:
                readback.next = pattern_word

    @always_comb
    def show_slots():
        bad_rectangle.next = bad != 0
        rects.usable.next = usable

    if config.facts.rect_latency == 1:

        @always_comb
        def choose():
            chosen.word.next = live_words[rects.index]

        @always(clk.posedge)
        def present():
            if rects.fetch:
                rects.rect.word.next = sorted_rect.word

    else:

        @always(clk.posedge)
        def choose():
            if rects.fetch:
                chosen.word.next = live_words[rects.index]

        @always(clk.posedge)
        def present():
            rects.rect.word.next = sorted_rect.word

    return instances()
