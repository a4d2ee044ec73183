# SPDX-License-Identifier: MIT
"""The reset of a board: from power-up until the clock has been good for a while."""

from myhdl import always_comb, always_seq, block

from raycaster.rtl.widths import bit, bits_for, unsigned

HOLD_CYCLES = 16
"""Clock cycles that reset lasts after `ready` was seen."""


@block
def reset_release(clk, ready, reset):
    """Hold reset until `ready`, which may change at any time, has been high for `HOLD_CYCLES`.

    The registers here have no reset of their own: chips power up with them at 0, and simulators set them by a low
    `ready` of three cycles. reset: high again three cycles after ready fell.
    """
    last = HOLD_CYCLES
    arriving, steady = bit(), bit()
    held = unsigned(bits_for(HOLD_CYCLES + 1))

    # Two registers, as ready is not of this clock.
    @always_seq(clk.posedge, reset=None)
    def synchronise():
        arriving.next = ready
        steady.next = arriving

    # How long it has been ready, as far as that matters.
    @always_seq(clk.posedge, reset=None)
    def count():
        if not steady:
            held.next = 0
        elif held != last:
            held.next = held + 1

    # Reset ends with the count.
    @always_comb
    def drive():
        reset.next = held != last

    return synchronise, count, drive
