# SPDX-License-Identifier: MIT
"""Whether any ray of a group can hit a rectangle."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def group_tester(clk, load, facet, growth, start, column_slope, row_slope, possible, config: Configuration):
    """Test the rays at a group's ends against one rectangle after another, as rect_setup presents them.

    Along a row both sides of each condition of the hit are linear in the column. What fails at both ends, for a ray
    that runs the same way along the rectangle's axis at both, fails between them too: then no ray of the group hits.
    Otherwise one may. The ends are the first column and the one after the last, as that many columns on are a shift
    where units are a power of two. possible: a bit for each rectangle; load says whose stands two cycles later.
    """
    walk_bits, units = len(start.way_u), config.units

    reach_way_u, reach_low_u, reach_high_u, reach_low_v, reach_high_v = (signed(walk_bits) for _ in range(5))
    end_way_u, end_low_u, end_high_u, end_low_v, end_high_v = (signed(walk_bits) for _ in range(5))
    end_slope = signed(len(column_slope) + 1)
    back, end_back = bit(), bit()
    behind = bit()
    least_u, most_u, least_v, most_v = (signed(walk_bits) for _ in range(4))
    under_u, over_u, under_v, over_v = (bit() for _ in range(4))

    load_1 = unsigned(config.rectangles)
    behind_1, same_way_1, turned_1 = bit(), bit(), bit()
    under_u_1, over_u_1, under_v_1, over_v_1 = (bit() for _ in range(4))
    way_u_1, low_u_1, high_u_1, low_v_1, high_v_1 = (signed(walk_bits) for _ in range(5))
    way_v_1 = signed(len(facet.way_v))
    end_least_u, end_most_u, end_least_v, end_most_v = (signed(walk_bits) for _ in range(4))
    may_hit = bit()

    # From one end to the other.
    @always_comb
    def stretch():
        reach_way_u.next = growth.way_u * units
        reach_low_u.next = growth.low_u * units
        reach_high_u.next = growth.high_u * units
        reach_low_v.next = growth.low_v * units
        reach_high_v.next = growth.high_v * units
        end_slope.next = column_slope + units

    # What stands there.
    @always_comb
    def walk():
        end_way_u.next = start.way_u + reach_way_u
        end_low_u.next = start.low_u + reach_low_u
        end_high_u.next = start.high_u + reach_high_u
        end_low_v.next = start.low_v + reach_low_v
        end_high_v.next = start.high_v + reach_high_v

    # Which way the two rays run along the rectangle's axis.
    @always_comb
    def look_ahead():
        back.next = False
        end_back.next = False
        if facet.axis == 1:
            back.next = column_slope < 0
            end_back.next = end_slope < 0
        elif facet.axis == 2:
            back.next = row_slope < 0
            end_back.next = row_slope < 0

    # Away from the plane, both of them, or along it.
    @always_comb
    def look_behind():
        if facet.distance < 0:
            behind.next = (not back) and (not end_back)
        elif facet.distance == 0:
            behind.next = True
        else:
            behind.next = back and end_back

    # Where the ray runs back, multiplying by its slope has turned the bounds around.
    @always_comb
    def order_bounds():
        if back:
            least_u.next = start.high_u
            most_u.next = start.low_u
            least_v.next = start.high_v
            most_v.next = start.low_v
        else:
            least_u.next = start.low_u
            most_u.next = start.high_u
            least_v.next = start.low_v
            most_v.next = start.high_v

    # On which sides the first column's ray passes.
    @always_comb
    def compare():
        under_u.next = start.way_u < least_u
        over_u.next = start.way_u > most_u
        under_v.next = facet.way_v < least_v
        over_v.next = facet.way_v > most_v

    # The first stage: the verdict at one end, and the products at the other.
    @always(clk.posedge)
    def stage_1():
        load_1.next = load
        behind_1.next = behind
        turned_1.next = end_back
        same_way_1.next = back == end_back
        under_u_1.next = under_u
        over_u_1.next = over_u
        under_v_1.next = under_v
        over_v_1.next = over_v
        way_u_1.next = end_way_u
        low_u_1.next = end_low_u
        high_u_1.next = end_high_u
        low_v_1.next = end_low_v
        high_v_1.next = end_high_v
        way_v_1.next = facet.way_v

    # There the bounds turn around likewise.
    @always_comb
    def order_end_bounds():
        if turned_1:
            end_least_u.next = high_u_1
            end_most_u.next = low_u_1
            end_least_v.next = high_v_1
            end_most_v.next = low_v_1
        else:
            end_least_u.next = low_u_1
            end_most_u.next = high_u_1
            end_least_v.next = low_v_1
            end_most_v.next = high_v_1

    # Passing on one side at both ends is a miss for all.
    @always_comb
    def judge():
        may_hit.next = not (
            behind_1
            or (same_way_1 and under_u_1 and (way_u_1 < end_least_u))
            or (same_way_1 and over_u_1 and (way_u_1 > end_most_u))
            or (same_way_1 and under_v_1 and (way_v_1 < end_least_v))
            or (same_way_1 and over_v_1 and (way_v_1 > end_most_v))
        )

    # The second stage: the rectangle's bit.
    @always(clk.posedge)
    def stage_2():
        for i in range(config.rectangles):
            if load_1[i]:
                possible.next[i] = may_hit

    return (
        stretch, walk, look_ahead, look_behind, order_bounds, compare, stage_1, order_end_bounds, judge, stage_2,
    )  # fmt: skip
