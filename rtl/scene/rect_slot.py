# SPDX-License-Identifier: MIT
"""Where a rectangle's shadow, pending and live copy are, and which of them may be shown."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.scene.written_rect import PLACE_BITS


@block
def rect_slot(clk, reset, bus, storing, index, number, place, enable, flat, copies, usable, bad):
    """Keep the places of a rectangle's shadow, pending and live copy, and which of them may be shown.

    bus.commit and bus.go_live move no rectangle: they change which copy each place holds.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        bus: `SceneBus`; reads commit and go_live.
        storing: strobe; the rectangle of the slot index goes to the place of this number, and its shadow's copy is
            there from then on.
        index: unsigned, as wide as number; the slot that is stored, read with storing.
        number: unsigned; the slot's own index, constant.
        place: unsigned, `PLACE_BITS` bits; the place's number, read with storing.
        enable: flag; the rectangle that is stored is enabled. Read with storing.
        flat: flag; the rectangle that is stored has a plane. Read with storing.
        copies: `Copies`; output, the places of the slot's copies.
        usable: flag; output, the live rectangle is enabled and has a plane.
        bad: flag; output, the shadow's rectangle is enabled and has no plane.
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

    whole = copies.joined(shadow=shadow, pending=pending, live=live)

    @always_comb
    def join():
        copies.word.next = whole

    return instances()
