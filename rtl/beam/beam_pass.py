# SPDX-License-Identifier: MIT
"""The primary ray, or one of its reflections: every rectangle at once, a column a clock."""

from collections.abc import Sequence

from myhdl import always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.beam import fold_tester as tester
from raycaster.rtl.beam import nearest_of_two as contest
from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.beam.nearest_of import nearest_of
from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.records import Facet, Walk, candidate_of
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import DISTANCE_BITS, exact_slope_bits, index_bits, side_by_side, signed, walk_bits


def rounds(config: Configuration) -> int:
    """Rounds in which the nearest of a pass's rectangles is found, two by two; one alone has one too."""
    most = max(mask.bit_count() for mask in config.passes)
    return max(1, (most - 1).bit_length())


def winner_latency(config: Configuration) -> int:
    """Cycles from a pass's ray to the rectangle that it sees."""
    return tester.LATENCY + rounds(config) * contest.LATENCY


@block
def beam_pass(
    clk, start_line, load, step, step_bounds, step_slope, start, row_slope, facets, growths, fold, winner,
    tested: Sequence[int], config: Configuration,
):  # fmt: skip
    """A column at each step; winner follows winner_latency cycles later.

    facets, growths: each rectangle's `Facet`, and what a column adds to its `Walk`, side by side, the first in the
    lowest bits; load: a bit for each, high where start is its own. step_bounds, step_slope: step one and two cycles
    later, for what is read then. fold: the ray's; tested: numbers of the rectangles that it may meet. start_line,
    row_slope: as in `beam_caster`.
    """
    slope_bits, product_bits, view_distance = (
        exact_slope_bits(config), walk_bits(config), config.screen_geometry.view_distance
    )  # fmt: skip
    early_slope, late_slope, slope = signed(slope_bits + 1), signed(slope_bits + 1), Slope(slope_bits)
    seen = [Facet(product_bits).cut(facets, i) for i in tested]
    grown = [Walk(DISTANCE_BITS).cut(growths, i) for i in tested]
    walks, hits = [Walk(product_bits) for _ in tested], [candidate_of(config) for _ in tested]

    walkers = [
        rect_walker(clk, load=load(i + 1, i), step_way=step, step_bounds=step_bounds, start=start,
            growth=growth, walk=walk)
        for i, growth, walk in zip(tested, grown, walks, strict=True)
    ]  # fmt: skip
    early = slope_walker(clk, start_line, step, early_slope, config)
    late = slope_walker(clk, start_line, step_slope, late_slope, config)
    magnitudes = magnitude(late_slope, slope.dy), magnitude(row_slope, slope.dz)
    testers = [
        fold_tester(clk, facet=facet, walk=walk, column_slope=early_slope, row_slope=row_slope, slope=slope, fold=fold,
            index=tied(i, index_bits(config)), hit=hit, view_distance=view_distance)
        for i, facet, walk, hit in zip(tested, seen, walks, hits, strict=True)
    ]  # fmt: skip
    all_hits, nearest = side_by_side([hit.word for hit in hits]), candidate_of(config)
    contests = nearest_of(clk, all_hits, nearest, rounds(config))

    # How near it is does not matter any more.
    @always_comb
    def announce():
        winner.word.next = concat(nearest.valid, nearest.index)

    return instances()
