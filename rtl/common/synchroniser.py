# SPDX-License-Identifier: MIT
"""Into this clock, from none."""

from myhdl import Signal, always_seq, block, instances

from raycaster.rtl.common.ties import initial


@block
def synchroniser(clk, reset, value, held):
    """Two registers in a row, as the first may be metastable: held is value, which may change at any time, two cycles
    later. reset: both to 0; None for registers without one.
    """
    arriving = Signal(initial(0, held))

    @always_seq(clk.posedge, reset=reset)
    def synchronise():
        arriving.next = value
        held.next = arriving

    return instances()
