# SPDX-License-Identifier: MIT
"""One word of the scene: a shadow that software writes, a copy that waits, and the one that is shown."""

from myhdl import Signal, always_comb, always_seq, block, instances, intbv

from raycaster.rtl.common.widths import WORD_BITS, unsigned


@block
def scene_word(clk, reset, bus, selected, implemented, shadow, live, first: int = 0):
    """shadow takes bus.data under bus.mask when selected and written; bus.commit copies it to a pending word, and
    bus.go_live that to live.

    implemented: constant, the bits that exist; the others read 0. first: what reset gives to all three; the caller's
    shadow and live start with it. go_live without a commit changes nothing, as live already is what was committed last.
    """
    merged, pending = unsigned(WORD_BITS), Signal(intbv(first)[WORD_BITS:])

    @always_comb
    def merge():
        merged.next = ((shadow & ~bus.mask) | (bus.data & bus.mask)) & implemented

    # Two conditions, of which a simulator tests the first once for all words.
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
