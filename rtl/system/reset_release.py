# SPDX-License-Identifier: MIT
"""The reset of a board: from power-up until the clock has been good for a while."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.rtl.common.synchroniser import synchroniser
from raycaster.rtl.common.widths import bit, unsigned

HOLD_CYCLES = 16
"""Clock cycles that reset lasts after `ready` was seen."""


@block
def reset_release(clk, ready, reset):
    """Hold reset until ready has been high for `HOLD_CYCLES` cycles.

    The registers here have no reset: chips power up with them at 0, and simulators set them by a low ready of three
    cycles.

    Args:
        clk: the clock.
        ready: flag; the clock is good. It may change at any time.
        reset: output, active high; high again three cycles after ready fell.
    """
    last = HOLD_CYCLES - 1
    steady = bit()
    held = unsigned(HOLD_CYCLES)

    synchronised = synchroniser(clk, None, value=ready, held=steady)

    # A one moves up each cycle while ready is high, and reset ends when it has arrived.
    @always_seq(clk.posedge, reset=None)
    def shift():
        held.next = 0
        if steady:
            held.next[HOLD_CYCLES:1] = held[last:]
            held.next[0] = True

    @always_comb
    def drive():
        reset.next = not held[last]

    return instances()
