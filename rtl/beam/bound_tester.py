# SPDX-License-Identifier: MIT
"""A test of a ray against a rectangle's two bounds on one axis, from existing products."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, signed


@block
def bound_tester(clk, step, back, way, low, high, between):
    """Test whether a ray meets a plane between a rectangle's two bounds on an axis other than the plane's axis.

    On that axis, the ray meets the plane at way / D[a], and the bounds are at low / D[a] and high / D[a]. If D[a] is
    negative, the bounds change places. As way <= low is the same as 2 way < 2 low + 1, one comparison per bound serves
    both signs, with the sign as the lowest bit.

    Args:
        clk: the clock.
        step: strobe; takes back, way, low and high.
        back: flag; D[a] is negative.
        way: signed; distance from the eye to the point on the plane, times D[a].
        low: signed; distance from the eye to the lower bound, times D[a].
        high: signed, as wide as low; distance from the eye to the upper bound, times D[a].
        between: output flag; the ray meets the plane between the bounds. Valid from the cycle after step until the next
            step.
    """
    edge_bits, bound_bits = len(way) + 1, len(low) + 1
    twice, way_edge = signed(edge_bits), signed(edge_bits)
    twice_low, twice_high, low_edge = (signed(bound_bits) for _ in range(3))
    under_low, over_high, back_1 = bit(), bit(), bit()

    @always_comb
    def double():
        twice.next = way << 1
        twice_low.next = low << 1
        twice_high.next = high << 1

    @always_comb
    def add_sign():
        way_edge.next = twice | back
        low_edge.next = twice_low | back

    @always(clk.posedge)
    def compare():
        if step:
            back_1.next = back
            under_low.next = twice < low_edge
            over_high.next = twice_high < way_edge

    @always_comb
    def judge():
        between.next = (under_low == back_1) and (over_high == back_1)

    return instances()
