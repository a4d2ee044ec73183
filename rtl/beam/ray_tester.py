# SPDX-License-Identifier: MIT
"""A test of a ray from the camera against a rectangle."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.beam.bound_tester import bound_tester
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.magnitude import magnitude


@block
def ray_tester(clk, step_way, step_bounds, step_slope, facet, walk, signs, slope, index, hit, staged: bool):
    """Test whether a ray from the camera hits a rectangle: one ray per clock, the hit `TESTER_LATENCY` cycles later.

    Along p the ray meets the plane at W / D[a], with W = n D[p]: it hits if that is between the two bounds.

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
        hit: `Candidate`; output, `TESTER_LATENCY` cycles after the ray's cycle; at_mirror is 0.
        staged: register the component that the block chooses from slope; see is_staged.
    """
    way_q = walk.way_q if walk.has("way_q") else facet.way_q
    numerator_bits, slope_bits = len(hit.numerator), len(slope.dy)

    back, back_1, back_2, ahead = bit(), bit(), bit(), bit()
    inside_p, inside_q, valid = bit(), bit(), bit()
    size, numerator = unsigned(len(facet.distance) - 1), unsigned(numerator_bits)
    e, size_a = unsigned(slope_bits), unsigned(slope_bits)

    # back: D[a] is negative; e is |D[a]|.
    sign = by_axis(facet.axis, signs.dx, signs.dy, signs.dz, back, width=len(back))
    size_chosen = by_axis(facet.axis, slope.dx, slope.dy, slope.dz, size_a if staged else e, width=len(size_a))
    along_p = bound_tester(clk, step_bounds, back_1, way=walk.way_p, low=walk.low_p, high=walk.high_p, between=inside_p)
    along_q = bound_tester(clk, step_bounds, back_1, way=way_q, low=walk.low_q, high=walk.high_q, between=inside_q)
    distance = magnitude(facet.distance, size)

    @always(clk.posedge)
    def follow_sign():
        if step_way:
            back_1.next = back
        if step_bounds:
            back_2.next = back_1

    if staged:

        @always(clk.posedge)
        def hold_slope():
            if step_bounds:
                e.next = size_a

    @always_comb
    def extend():
        numerator.next = size

    # The plane must lie on the side that the ray runs to.
    @always_comb
    def judge():
        ahead.next = (numerator != 0) and ((facet.distance < 0) == back_2)

    @always_comb
    def conclude():
        valid.next = facet.usable and ahead and inside_p and inside_q and (e != 0)

    result = hit.joined(
        valid=valid, at_mirror=False, numerator=numerator, denominator=e, axis=facet.axis, cell=facet.cell, index=index
    )

    @always(clk.posedge)
    def report():
        if step_slope:
            hit.word.next = result

    return instances()
