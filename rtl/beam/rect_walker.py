# SPDX-License-Identifier: MIT
"""A rectangle's products from column to column, without a multiplier."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import signed


@block
def rect_walker(clk, load, step_way, step_bounds, start, growth, walk):
    """Advance a rectangle's products from column to column, without a multiplier.

    Integers at their full width do not drift, so the products of every column are exact (forward differences).
    fold_tester reads the ways and the bounds in different cycles, so they have separate steps. Each field has its own
    register, so that a simulator need not split the word of walk to add to it.

    Args:
        clk: the clock.
        load: strobe; takes start.
        step_way: strobe; adds growth to the ways. load takes precedence.
        step_bounds: strobe; adds growth to the bounds. load takes precedence.
        start: `Walk`, as wide as walk; read with load.
        growth: `Walk`; the change per step, read with the steps.
        walk: `Walk`; output, start from the cycle after load on, plus growth after each step.
    """
    product_bits = len(walk.way_p)
    way_p, way_q, low_p, high_p, low_q, high_q = (signed(product_bits) for _ in range(6))

    @always(clk.posedge)
    def advance_way():
        if load:
            way_p.next = start.way_p
        elif step_way:
            way_p.next = way_p + growth.way_p

    @always(clk.posedge)
    def advance_bounds():
        if load:
            low_p.next = start.low_p
            high_p.next = start.high_p
            low_q.next = start.low_q
            high_q.next = start.high_q
        elif step_bounds:
            low_p.next = low_p + growth.low_p
            high_p.next = high_p + growth.high_p
            low_q.next = low_q + growth.low_q
            high_q.next = high_q + growth.high_q

    if walk.has("way_q"):

        @always(clk.posedge)
        def advance_way_q():
            if load:
                way_q.next = start.way_q
            elif step_way:
                way_q.next = way_q + growth.way_q

    here = walk.joined(way_p=way_p, way_q=way_q, low_p=low_p, high_p=high_p, low_q=low_q, high_q=high_q)

    @always_comb
    def join():
        walk.word.next = here

    return instances()
