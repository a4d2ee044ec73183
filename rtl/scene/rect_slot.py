# SPDX-License-Identifier: MIT
"""The banks of a rectangle's shadow, pending and live copy, and which of them are usable."""

from myhdl import always_seq, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.scene.written_rect import BANK_BITS


@block
def rect_slot(clk, reset, bus, storing, index, number, bank, enable, flat, copies, usable, bad):
    """Keep track of the banks of a rectangle's shadow, pending and live copy, and of whether each is usable.

    bus.commit and bus.go_live move no rectangle: they change which copy each bank holds.

    Args:
        bus: `SceneBus`; reads commit and go_live.
        storing: strobe; the rectangle of slot index is stored at bank, which becomes the bank of the slot's shadow
            copy.
        index: unsigned, as wide as number; the slot that is stored, read with storing.
        number: unsigned; the slot's own index, constant.
        bank: unsigned, `BANK_BITS` bits; number of the bank, read with storing.
        enable: flag; the stored rectangle is enabled. Read with storing.
        flat: flag; the stored rectangle lies in a plane. Read with storing.
        copies: `Copies`; output, the banks of the slot's copies.
        usable: flag; output, the live rectangle is enabled and has a plane.
        bad: flag; output, the shadow's rectangle is enabled and has no plane.
    """
    shadow, pending, live = (unsigned(BANK_BITS) for _ in range(3))
    shadow_usable, pending_usable = bit(), bit()

    @always_seq(clk.posedge, reset=reset)
    def follow_shadow():
        if storing and index == number:
            shadow.next = bank
            shadow_usable.next = enable and flat
            bad.next = enable and not flat

    @always_seq(clk.posedge, reset=reset)
    def commit():
        if bus.commit:
            pending.next, pending_usable.next = shadow, shadow_usable

    @always_seq(clk.posedge, reset=reset)
    def go_live():
        if bus.go_live:
            live.next, usable.next = pending, pending_usable

    whole = copies.joined(shadow=shadow, pending=pending, live=live)
    join = assign(copies.word, lambda: whole)

    return instances()
