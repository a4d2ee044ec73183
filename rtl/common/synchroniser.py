# SPDX-License-Identifier: MIT
"""A synchroniser with two registers."""

from myhdl import Signal, always_seq, block, instances

from raycaster.hdl.signals import initial


@block
def synchroniser(clk, reset, value, held):
    """Synchronise a value that may change at any time to clk.

    There are two registers in series, because the first may become metastable.

    Args:
        reset: synchronous reset, which sets both registers to 0. None for registers without reset.
        value: flag or unsigned; may change at any time.
        held: output, as wide as value; value, two cycles later.
    """
    arriving = Signal(initial(0, held))

    @always_seq(clk.posedge, reset=reset)
    def synchronise():
        arriving.next, held.next = value, arriving

    return instances()
