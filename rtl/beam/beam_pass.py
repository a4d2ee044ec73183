# SPDX-License-Identifier: MIT
"""A pass of the primary ray or of one of its reflections: all rectangles at once, one column per clock."""

from collections.abc import Sequence
from functools import partial

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import side_by_side, tied
from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.beam.latencies import contest_latency, is_staged, rounds
from raycaster.rtl.beam.nearest_of import nearest_of
from raycaster.rtl.beam.ray_tester import ray_tester
from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.beam.slope_walker import ray_slope, slope_walker
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.records import Candidate, Facet, Signs, Walk, stride_of
from raycaster.rtl.common.widths import exact_slope_bits, index_bits


@block
def beam_pass(
    clk, start_line, load, step, step_way, step_bounds, step_slope, start, aim, facets, growths, fold, nearest,
    winner, tested: Sequence[int], reflected: bool, config: Configuration,
):  # fmt: skip
    """Test a column's ray, primary or reflected, against all rectangles at once: a column at each step.

    winner and nearest follow `winner_latency` cycles after step.

    Args:
        clk: the clock.
        start_line: strobe; begins a line, as in slope_walker. With a camera that turns it loads the start of all
            rectangles.
        load: `config.rectangles` bits, high for the rectangle that start belongs to; not read if the camera turns.
        step: strobe; a column's ray begins.
        step_way: strobe; equal to step, or to step_bounds for rays from the camera, which read their ways with the
            bounds.
        step_bounds: strobe; step one cycle later.
        step_slope: strobe; step two cycles later.
        start: `Walk`; the start of the rectangle that load names.
        aim: `Vector`; as in slope_walker.
        facets: `Facet` of each rectangle, side by side, the first in the lowest bits.
        growths: the change per step of each rectangle's `Walk`, side by side, the first in the lowest bits.
        fold: `Fold` of the ray, `fold_lead` cycles before its step; read only if reflected.
        nearest: `Candidate`; output, the nearest hit.
        winner: `Winner`; output, the rectangle of the nearest hit.
        tested: numbers of the rectangles that the ray may meet.
        reflected: the ray comes from a mirror, not from the camera.
        config: the design.
    """
    slope_bits = exact_slope_bits(config)
    straight, signs = ray_slope(aim, config), Signs()
    size, size_1 = Slope(slope_bits), Slope(slope_bits)
    tested_facets = [Facet(config).cut(facets, i) for i in tested]
    grown = [stride_of(config).cut(growths, i) for i in tested]
    walks, hits = [Walk(config) for _ in tested], [Candidate(config) for _ in tested]

    walkers = [
        rect_walker(clk, load=start_line if config.turn else load(i + 1, i), step_way=step_way, step_bounds=step_bounds,
            start=start, growth=growth, walk=walk)
        for i, growth, walk in zip(tested, grown, walks, strict=True)
    ]  # fmt: skip
    walker = slope_walker(clk, start_line, step, aim=aim, slope=straight, config=config)
    magnitudes = [
        magnitude(value, result)
        for value, result in ((straight.x, size.dx), (straight.y, size.dy), (straight.z, size.dz))
    ]

    all_signs = signs.joined(dx=straight.x(slope_bits), dy=straight.y(slope_bits), dz=straight.z(slope_bits))

    @always_comb
    def look_ahead():
        signs.word.next = all_signs

    @always(clk.posedge)
    def follow():
        if step:
            size_1.dx.next = size.dx
            size_1.dy.next = size.dy
            size_1.dz.next = size.dz

    if is_staged(config):
        tested_size = size_1
    else:
        tested_size = Slope(slope_bits)

        @always(clk.posedge)
        def follow_again():
            if step_bounds:
                tested_size.dx.next = size_1.dx
                tested_size.dy.next = size_1.dy
                tested_size.dz.next = size_1.dz

    tests = partial(fold_tester, fold=fold) if reflected else ray_tester
    testers = [
        tests(clk, step_way=step, step_bounds=step_bounds, step_slope=step_slope, facet=facet, walk=walk, signs=signs,
            slope=tested_size, index=tied(i, index_bits(config)), hit=hit, staged=is_staged(config))
        for i, facet, walk, hit in zip(tested, tested_facets, walks, hits, strict=True)
    ]  # fmt: skip
    all_hits = side_by_side([hit.word for hit in hits])
    contests = nearest_of(clk, all_hits, nearest, rounds(config), contest_latency(config))

    named = winner.joined(valid=nearest.valid, at_mirror=nearest.at_mirror, index=nearest.index)

    @always_comb
    def announce():
        winner.word.next = named

    return instances()
