# SPDX-License-Identifier: MIT
"""The reset of a board: from power-up until the clock has been stable for a while."""

from myhdl import always_seq, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.synchroniser import synchroniser

HOLD_CYCLES = 16
"""Clock cycles for which reset lasts after `ready` is seen high."""


@block
def reset_release(clk, ready, reset):
    """Hold reset until ready has been high for `HOLD_CYCLES` cycles.

    The registers here have no reset: chips power up with them at 0, and simulators need a low ready for three cycles.

    Args:
        ready: flag; the clock is stable. It may change at any time.
        reset: output, active high; high again three cycles after ready has fallen.
    """
    last = HOLD_CYCLES - 1
    steady = bit()
    held = unsigned(HOLD_CYCLES)

    synchronised = synchroniser(clk, None, value=ready, held=steady)

    # Ones shift in while ready is high, and reset ends when the first one reaches the top bit.
    @always_seq(clk.posedge, reset=None)
    def shift():
        held.next = 0
        if steady:
            held.next[HOLD_CYCLES:1] = held[last:]
            held.next[0] = True

    drive = assign(reset, lambda: not held[last])

    return instances()
