# SPDX-License-Identifier: MIT
"""A word of the scene: the shadow that software writes, a pending copy, and the live one."""

from myhdl import Signal, always_seq, block, instances, intbv

from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import WORD_BITS


@block
def scene_word(clk, reset, bus, selected, implemented, shadow, live, first: int = 0):
    """Keep a word of the scene three times: the shadow that software writes, a pending copy, and the live one.

    shadow takes bus.data under bus.mask when the word is selected and bus.write is high, bus.commit copies shadow to
    the pending word, and bus.go_live copies the pending word to live. go_live without a commit changes nothing, as live
    already holds the last committed word.

    Args:
        reset: synchronous, active high; sets all three to first.
        bus: `SceneBus`; input.
        selected: flag; bus.address is the address of this word.
        implemented: unsigned, 32 bits, constant; the bits that exist. The others read 0.
        shadow: unsigned, 32 bits; output, with first as its initial value.
        live: unsigned, 32 bits; output, with first as its initial value.
        first: the reset value.
    """
    merged, pending = unsigned(WORD_BITS), Signal(intbv(first)[WORD_BITS:])

    merge = assign(merged, lambda: ((shadow & ~bus.mask) | (bus.data & bus.mask)) & implemented)

    # Two conditions, so that a simulator tests bus.write once for all words.
    @always_seq(clk.posedge, reset=reset)
    def write():
        if bus.write:  # noqa: SIM102
            if selected:
                shadow.next = merged

    @always_seq(clk.posedge, reset=reset)
    def commit():
        if bus.commit:
            pending.next = shadow

    @always_seq(clk.posedge, reset=reset)
    def go_live():
        if bus.go_live:
            live.next = pending

    return instances()
