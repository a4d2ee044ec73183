# SPDX-License-Identifier: MIT
"""The reset of a board: from power-up until the clock has been good for a while."""

from myhdl import always_comb, always_seq, block

from raycaster.rtl.common.widths import bit, unsigned

HOLD_CYCLES = 16
"""Clock cycles that reset lasts after `ready` was seen."""


@block
def reset_release(clk, ready, reset):
    """Hold reset until `ready`, which may change at any time, has been high for `HOLD_CYCLES`.

    The registers here have no reset of their own: chips power up with them at 0, and simulators set them by a low
    `ready` of three cycles. reset: high again three cycles after ready fell.
    """
    last = HOLD_CYCLES - 1
    arriving, steady = bit(), bit()
    held = unsigned(HOLD_CYCLES)

    # Two registers, as ready is not of this clock.
    @always_seq(clk.posedge, reset=None)
    def synchronise():
        arriving.next = ready
        steady.next = arriving

    # A one moves up for each cycle in which it is ready.
    @always_seq(clk.posedge, reset=None)
    def shift():
        held.next = 0
        if steady:
            held.next[HOLD_CYCLES:1] = held[last:]
            held.next[0] = True

    # Reset ends when the first has arrived.
    @always_comb
    def drive():
        reset.next = not held[last]

    return synchronise, shift, drive
