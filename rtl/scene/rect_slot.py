# SPDX-License-Identifier: MIT
"""Where a rectangle's shadow, pending and live copy are, and which of them may be shown."""

from myhdl import always_comb, always_seq, block, concat, instances

from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.scene.written_rect import PLACE_BITS


@block
def rect_slot(clk, reset, bus, storing, index, number, place, enable, flat, copies, usable, bad):
    """storing: the rectangle of this index goes to its place `place`, where its shadow's copy is from then on.

    number: constant, the slot's own index. enable, flat: what goes there is enabled, and has a plane. copies: `Copies`;
    bus.commit and bus.go_live move no rectangle, they change whose its places are. usable: the live rectangle is
    enabled and has a plane. bad: the shadow's is enabled and has none.
    """
    shadow, pending, live = (unsigned(PLACE_BITS) for _ in range(3))
    shadow_usable, pending_usable = bit(), bit()

    @always_seq(clk.posedge, reset=reset)
    def follow_shadow():
        if storing and index == number:
            shadow.next = place
            shadow_usable.next = enable and flat
            bad.next = enable and not flat

    @always_seq(clk.posedge, reset=reset)
    def commit():
        if bus.commit:
            pending.next = shadow
            pending_usable.next = shadow_usable

    @always_seq(clk.posedge, reset=reset)
    def go_live():
        if bus.go_live:
            live.next = pending
            usable.next = pending_usable

    @always_comb
    def join():
        copies.word.next = concat(shadow, pending, live)

    return instances()
