# SPDX-License-Identifier: MIT
"""One rectangle of the scene."""

from myhdl import always_comb, always_seq, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit, unsigned
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.rtl.scene.written_rect import CORNER, PATTERN, surface_mask


@block
def rect_slot(clk, reset, bus, number, shadow, live, usable, bad, config: Configuration):
    """The words of a rectangle, each a scene_word; shadow, live: WrittenRect.

    number: constant, the slot's address in units of four words. usable: the live rectangle is enabled and has a plane.
    bad: the shadow's is enabled and has none.
    """
    address_width = len(bus.address)
    corner_bits, surface_bits = tied(CORNER.implemented, WORD_BITS), tied(surface_mask(config), WORD_BITS)
    corner_0, corner_1, surface, live_corner_0, live_corner_1, live_surface = (unsigned(WORD_BITS) for _ in range(6))
    select_corner_0, select_corner_1, select_surface = (bit() for _ in range(3))
    flat, pending_usable = bit(), bit()

    word_0 = scene_word(clk, reset, bus, select_corner_0, implemented=corner_bits, shadow=corner_0, live=live_corner_0)
    word_1 = scene_word(clk, reset, bus, select_corner_1, implemented=corner_bits, shadow=corner_1, live=live_corner_1)
    word_2 = scene_word(clk, reset, bus, select_surface, implemented=surface_bits, shadow=surface, live=live_surface)

    @always_comb
    def decode():
        select_corner_0.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 0)
        select_corner_1.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 1)
        select_surface.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 2)

    if config.patterns:
        pattern_bits = tied(PATTERN.implemented, WORD_BITS)
        pattern, live_pattern = unsigned(WORD_BITS), unsigned(WORD_BITS)
        select_pattern = bit()
        word_3 = scene_word(
            clk, reset, bus, select_pattern, implemented=pattern_bits, shadow=pattern, live=live_pattern
        )

        @always_comb
        def decode_pattern():
            select_pattern.next = (bus.address[address_width:2] == number) and (bus.address[2:] == 3)

        @always_comb
        def join():
            shadow.word.next = concat(corner_0, corner_1, surface, pattern)
            live.word.next = concat(live_corner_0, live_corner_1, live_surface, live_pattern)

    else:

        @always_comb
        def join():
            shadow.word.next = concat(corner_0, corner_1, surface)
            live.word.next = concat(live_corner_0, live_corner_1, live_surface)

    # A rectangle lies in a plane where its corners share a coordinate.
    @always_comb
    def find_plane():
        flat.next = (shadow.x_0 == shadow.x_1) or (shadow.y_0 == shadow.y_1) or (shadow.z_0 == shadow.z_1)

    @always_comb
    def judge():
        bad.next = shadow.enable and not flat

    # What is live was judged in the shadow, when it was committed.
    @always_seq(clk.posedge, reset=reset)
    def commit():
        if bus.commit:
            pending_usable.next = shadow.enable and flat

    @always_seq(clk.posedge, reset=reset)
    def go_live():
        if bus.go_live:
            usable.next = pending_usable

    return instances()
