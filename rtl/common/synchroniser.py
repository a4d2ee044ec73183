# SPDX-License-Identifier: MIT
"""Into this clock, from none."""

from myhdl import Signal, always_seq, block, instances

from raycaster.rtl.common.ties import initial


@block
def synchroniser(clk, reset, value, held):
    """Bring a value that may change at any time to this clock.

    There are two registers in a row, as the first may be metastable.

    Args:
        clk: the clock.
        reset: synchronous reset, which sets both registers to 0. None for registers without reset.
        value: flag or unsigned; may change at any time.
        held: output, as wide as value; value, two cycles later.
    """
    arriving = Signal(initial(0, held))

    @always_seq(clk.posedge, reset=reset)
    def synchronise():
        arriving.next = value
        held.next = arriving

    return instances()
