# SPDX-License-Identifier: MIT
"""A test of a rectangle against all rays of a group."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, plus, register, times


@block
def group_tester(clk, load, facet, growth, start, column_slope, row_slope, may_hit, config: Configuration):
    """Test the rays at a group's ends against one rectangle after another, as rect_setup presents them.

    Along a row, both sides of each condition for a hit are linear in the column. If a condition fails at both ends, and
    the rays at both ends run the same way along the rectangle's axis, it fails in between too, and no ray of the group
    hits. Otherwise one may. The ends are the first column and the one after the last, `config.units` columns on: that
    is a shift for a power of two.

    Args:
        load: unsigned, `config.rectangles` bits, one per rectangle; high when facet, growth and start belong to that
            rectangle.
        facet: `Facet` of the rectangle; read with load.
        growth: `Walk`; the change of start per column, read with load.
        start: `Walk` of the group's first column; read with load.
        column_slope: signed; the y slope of the group's first column, read with load.
        row_slope: signed; the z slope of the group's row, read with load.
        may_hit: unsigned output, `config.rectangles` bits, one per rectangle; 1 if a ray of the group may hit it. Valid
            from the second cycle after the rectangle's bit of load.
    """
    walk_bits, units = len(start.way_p), config.units

    reach_way_p, stretch_way_p = times(growth.way_p, units, Signed(walk_bits))
    reach_low_p, stretch_low_p = times(growth.low_p, units, Signed(walk_bits))
    reach_high_p, stretch_high_p = times(growth.high_p, units, Signed(walk_bits))
    reach_low_q, stretch_low_q = times(growth.low_q, units, Signed(walk_bits))
    reach_high_q, stretch_high_q = times(growth.high_q, units, Signed(walk_bits))
    end_way_p, walk_way_p = plus(start.way_p, reach_way_p, Signed(walk_bits))
    end_low_p, walk_low_p = plus(start.low_p, reach_low_p, Signed(walk_bits))
    end_high_p, walk_high_p = plus(start.high_p, reach_high_p, Signed(walk_bits))
    end_low_q, walk_low_q = plus(start.low_q, reach_low_q, Signed(walk_bits))
    end_high_q, walk_high_q = plus(start.high_q, reach_high_q, Signed(walk_bits))
    end_slope, stretch_slope = plus(column_slope, units, Signed(len(column_slope) + 1))
    back, end_back = bit(), bit()
    behind = bit()
    least_p, most_p, least_q, most_q = (signed(walk_bits) for _ in range(4))
    under_p, over_p, under_q, over_q = (bit() for _ in range(4))

    load_1 = unsigned(config.rectangles)
    behind_1, same_way_1, turned_1 = bit(), bit(), bit()
    under_p_1, over_p_1, under_q_1, over_q_1 = (bit() for _ in range(4))
    way_p_1, low_p_1, high_p_1, low_q_1, high_q_1 = (signed(walk_bits) for _ in range(5))
    way_q_1 = signed(len(facet.way_q))
    end_least_p, end_most_p, end_least_q, end_most_q = (signed(walk_bits) for _ in range(4))
    one_may_hit = bit()

    @always_comb
    def look_ahead():
        back.next = end_back.next = False
        if facet.axis == 1:
            back.next = column_slope < 0
            end_back.next = end_slope < 0
        elif facet.axis == 2:
            back.next = end_back.next = row_slope < 0

    # Both rays run away from the plane, or along it.
    @always_comb
    def look_behind():
        if facet.distance < 0:
            behind.next = (not back) and (not end_back)
        elif facet.distance == 0:
            behind.next = True
        else:
            behind.next = back and end_back

    # If the ray runs in the negative direction, multiplying by its slope has swapped the bounds.
    order_least_p = assign(least_p, lambda: start.high_p if back else start.low_p)
    order_most_p = assign(most_p, lambda: start.low_p if back else start.high_p)
    order_least_q = assign(least_q, lambda: start.high_q if back else start.low_q)
    order_most_q = assign(most_q, lambda: start.low_q if back else start.high_q)
    compare = assign(
        (under_p, over_p, under_q, over_q),
        lambda: (start.way_p < least_p, start.way_p > most_p, facet.way_q < least_q, facet.way_q > most_q),
    )

    carry = register(clk, (load_1, behind_1, turned_1, same_way_1), lambda: (load, behind, end_back, back == end_back))
    carry_sides = register(clk, (under_p_1, over_p_1, under_q_1, over_q_1), lambda: (under_p, over_p, under_q, over_q))
    carry_p = register(clk, (way_p_1, low_p_1, high_p_1), lambda: (end_way_p, end_low_p, end_high_p))
    carry_q = register(clk, (way_q_1, low_q_1, high_q_1), lambda: (facet.way_q, end_low_q, end_high_q))

    order_end_least_p = assign(end_least_p, lambda: high_p_1 if turned_1 else low_p_1)
    order_end_most_p = assign(end_most_p, lambda: low_p_1 if turned_1 else high_p_1)
    order_end_least_q = assign(end_least_q, lambda: high_q_1 if turned_1 else low_q_1)
    order_end_most_q = assign(end_most_q, lambda: low_q_1 if turned_1 else high_q_1)

    # If the rays at both ends pass on the same side, all rays miss.
    @always_comb
    def judge():
        one_may_hit.next = not (
            behind_1
            or (same_way_1 and under_p_1 and (way_p_1 < end_least_p))
            or (same_way_1 and over_p_1 and (way_p_1 > end_most_p))
            or (same_way_1 and under_q_1 and (way_q_1 < end_least_q))
            or (same_way_1 and over_q_1 and (way_q_1 > end_most_q))
        )

    @always(clk.posedge)
    def stage_2():
        for i in range(config.rectangles):
            if load_1[i]:
                may_hit.next[i] = one_may_hit

    return instances()
