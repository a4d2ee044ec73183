# SPDX-License-Identifier: MIT
"""A rectangle's products from column to column, without a multiplier."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import signed


@block
def rect_walker(clk, load, step_way, step_bounds, start, growth, walk):
    """walk is start after load, and grows by growth after each step of its own.

    Integers at their full width do not drift, so every column's products are exact (forward differences). fold_tester
    reads the ways and the bounds in different cycles, so they have steps of their own. walk, start: of the same widths.
    """
    product_bits = len(walk.way_p)
    way_p, low_p, high_p, low_q, high_q = (signed(product_bits) for _ in range(5))

    @always_comb
    def grow():
        way_p.next = walk.way_p
        low_p.next = walk.low_p
        high_p.next = walk.high_p
        low_q.next = walk.low_q
        high_q.next = walk.high_q
        if step_way:
            way_p.next = walk.way_p + growth.way_p
        if step_bounds:
            low_p.next = walk.low_p + growth.low_p
            high_p.next = walk.high_p + growth.high_p
            low_q.next = walk.low_q + growth.low_q
            high_q.next = walk.high_q + growth.high_q

    if "way_q" in walk.layout:
        way_q = signed(product_bits)

        @always_comb
        def grow_q():
            way_q.next = walk.way_q
            if step_way:
                way_q.next = walk.way_q + growth.way_q

        @always(clk.posedge)
        def advance():
            if load:
                walk.word.next = start.word
            else:
                walk.word.next = concat(way_p[product_bits:], way_q, low_p, high_p, low_q, high_q)

    else:

        @always(clk.posedge)
        def advance():
            if load:
                walk.word.next = start.word
            else:
                walk.word.next = concat(way_p[product_bits:], low_p, high_p, low_q, high_q)

    return instances()
