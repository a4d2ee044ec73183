# SPDX-License-Identifier: MIT
"""A rectangle's products from column to column, without a multiplier."""

from myhdl import always, block


@block
def rect_walker(clk, load, step_way, step_bounds, start, growth, walk):
    """walk is start after load, and grows by growth after each step of its own.

    Integers at their full width do not drift, so every column's products are exact (forward differences). The way and
    the bounds have steps of their own, as those who read them want them in different cycles.
    """

    # Adders in place of multipliers.
    @always(clk.posedge)
    def advance():
        if load:
            walk.way_u.next = start.way_u
            walk.low_u.next = start.low_u
            walk.high_u.next = start.high_u
            walk.low_v.next = start.low_v
            walk.high_v.next = start.high_v
        else:
            if step_way:
                walk.way_u.next = walk.way_u + growth.way_u
            if step_bounds:
                walk.low_u.next = walk.low_u + growth.low_u
                walk.high_u.next = walk.high_u + growth.high_u
                walk.low_v.next = walk.low_v + growth.low_v
                walk.high_v.next = walk.high_v + growth.high_v

    return advance
