# SPDX-License-Identifier: MIT
"""Whether a ray from the camera hits a rectangle."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def ray_tester(clk, step_way, step_bounds, step_slope, facet, walk, signs, slope, index, hit, staged: bool):
    """Test whether a ray from the camera hits a rectangle: a ray per clock, the hit `TESTER_LATENCY` cycles later.

    Along p the ray meets the plane at W = n D[p], over D[a]: it hits if that is between the two bounds. If D[a] is
    negative the bounds have changed places, and W <= low is 2 W < 2 low + 1: one comparison per bound, with the sign as
    its lowest bit.

    The ray's cycle is the one in which step_way is high. The block takes its widths from its ports.

    Args:
        clk: the clock.
        step_way: strobe; high in the ray's cycle.
        step_bounds: strobe; high in the cycle after the ray's cycle.
        step_slope: strobe; high in the third cycle, two after the ray's cycle.
        facet: `Facet` of the rectangle, which serves all rays of a row.
        walk: `Walk` of the rectangle; read with step_bounds.
        signs: `Signs` of D; read with step_way.
        slope: `Slope`, the magnitudes of D; read with step_bounds if staged, otherwise with step_slope.
        index: unsigned, as wide as hit.index; the rectangle's number, constant.
        hit: `Candidate`; output, `TESTER_LATENCY` cycles after the ray's cycle, and never at a mirror.
        staged: registers the component that the block chooses from slope; see is_staged.
    """
    along_q = walk.way_q if "way_q" in walk.layout else facet.way_q
    distance_bits, numerator_bits, slope_bits = len(facet.distance), len(hit.numerator), len(slope.dy)
    edge_bits = len(walk.way_p) + 1

    back, back_1, back_2, ahead = bit(), bit(), bit(), bit()
    twice_p, twice_q, twice_low_p, twice_low_q, twice_high_p, twice_high_q = (signed(edge_bits) for _ in range(6))
    edge_p, edge_q, low_edge_p, low_edge_q = (signed(edge_bits) for _ in range(4))
    under_low_p, over_high_p, under_low_q, over_high_q = (bit() for _ in range(4))
    opposite_distance = signed(distance_bits + 1)
    numerator = unsigned(max(distance_bits, numerator_bits))
    e, e_2 = unsigned(slope_bits), unsigned(slope_bits)
    inside_p, inside_q, valid = bit(), bit(), bit()

    # D[a] is negative.
    @always_comb
    def choose_sign():
        if facet.axis == 0:
            back.next = signs.dx
        elif facet.axis == 1:
            back.next = signs.dy
        else:
            back.next = signs.dz

    @always_comb
    def double():
        twice_p.next = walk.way_p << 1
        twice_q.next = along_q << 1
        twice_high_p.next = walk.high_p << 1
        twice_high_q.next = walk.high_q << 1
        twice_low_p.next = walk.low_p << 1
        twice_low_q.next = walk.low_q << 1

    @always_comb
    def add_sign():
        edge_p.next = twice_p | back_1
        edge_q.next = twice_q | back_1
        low_edge_p.next = twice_low_p | back_1
        low_edge_q.next = twice_low_q | back_1

    @always(clk.posedge)
    def hold_sign():
        if step_way:
            back_1.next = back

    @always(clk.posedge)
    def compare():
        if step_bounds:
            back_2.next = back_1
            under_low_p.next = twice_p < low_edge_p
            over_high_p.next = twice_high_p < edge_p
            under_low_q.next = twice_q < low_edge_q
            over_high_q.next = twice_high_q < edge_q

    # |n|
    @always_comb
    def negate():
        opposite_distance.next = -facet.distance

    @always_comb
    def take_magnitude():
        numerator.next = facet.distance[distance_bits:]
        if facet.distance < 0:
            numerator.next = opposite_distance[distance_bits:]

    # e is |D[a]|.
    @always_comb
    def choose_slope():
        if facet.axis == 0:
            e.next = slope.dx
        elif facet.axis == 1:
            e.next = slope.dy
        else:
            e.next = slope.dz

    if staged:

        @always(clk.posedge)
        def hold_slope():
            if step_bounds:
                e_2.next = e

    else:
        e_2 = e

    # The plane must lie on the side that the ray runs to.
    @always_comb
    def judge():
        ahead.next = (numerator != 0) and ((facet.distance < 0) == back_2)
        inside_p.next = (under_low_p == back_2) and (over_high_p == back_2)
        inside_q.next = (under_low_q == back_2) and (over_high_q == back_2)

    @always_comb
    def conclude():
        valid.next = facet.usable and ahead and inside_p and inside_q and (e_2 != 0)

    if "cell" in hit.layout:

        @always(clk.posedge)
        def report():
            if step_slope:
                hit.word.next = concat(valid, False, numerator[numerator_bits:], e_2, facet.axis, facet.cell, index)

    else:

        @always(clk.posedge)
        def report():
            if step_slope:
                hit.word.next = concat(valid, False, numerator[numerator_bits:], e_2, index)

    return instances()
