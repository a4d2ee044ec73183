# SPDX-License-Identifier: MIT
"""The start values of two lanes, one column apart."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import signed


@block
def lane_start(clk, load, start, growth, late_load, first_start, second_start):
    """Form the starts of two lanes: the second lane is a column further along the row than the first.

    The outputs follow load and start a cycle later. The first lane's start has a register too, because it goes all over
    the chip from the multipliers' own registers.

    Args:
        clk: the clock.
        load: one bit per rectangle, high for the rectangle that start and growth belong to.
        start: `Walk`; the start of the row's first column.
        growth: `Walk`; the change of start per column.
        late_load: one bit per rectangle; output, load a cycle later.
        first_start: `Walk`; output, start a cycle later.
        second_start: `Walk`; output, the sum of start and growth a cycle later.
    """
    product_bits = len(start.way_p)
    way_p, low_p, high_p, low_q, high_q = (signed(product_bits) for _ in range(5))

    @always(clk.posedge)
    def advance():
        late_load.next = load
        first_start.word.next = start.word
        way_p.next = start.way_p + growth.way_p
        low_p.next = start.low_p + growth.low_p
        high_p.next = start.high_p + growth.high_p
        low_q.next = start.low_q + growth.low_q
        high_q.next = start.high_q + growth.high_q

    second = second_start.joined(way_p=way_p, way_q=start.way_q, low_p=low_p, high_p=high_p, low_q=low_q, high_q=high_q)

    @always_comb
    def join():
        second_start.word.next = second

    return instances()
