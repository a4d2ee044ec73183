# SPDX-License-Identifier: MIT
"""The beam engine: every rectangle at once, a pixel a clock."""

from myhdl import always, block, concat

from raycaster.configuration import Configuration
from raycaster.rtl import color_blend as blend
from raycaster.rtl import fold_tester as tester
from raycaster.rtl import nearest_of_two as contest
from raycaster.rtl import ray_fold as folder
from raycaster.rtl.color_blend import color_blend
from raycaster.rtl.facet_mem import facet_mem
from raycaster.rtl.fold_tester import fold_tester
from raycaster.rtl.hierarchy import constant, signed_constant, unconnected
from raycaster.rtl.interfaces import Candidate, Facet, Fold, Reflector, Slope, Walk
from raycaster.rtl.nearest_of_two import nearest_of_two
from raycaster.rtl.ray_fold import ray_fold
from raycaster.rtl.rect_setup import rect_setup
from raycaster.rtl.rect_walker import rect_walker
from raycaster.rtl.slope_magnitudes import slope_magnitudes
from raycaster.rtl.slope_walker import slope_walker
from raycaster.rtl.unopposed import unopposed
from raycaster.rtl.widths import (
    AXIS_BITS,
    COLOUR_BITS,
    DISTANCE_BITS,
    TURN_BITS,
    bit,
    exact_slope_bits,
    fold_bits,
    index_bits,
    signed,
    unsigned,
    walk_bits,
)
from raycaster.rtl.winner_delay import winner_delay

ENTRY_LATENCY = 1
"""Cycles from next_column to the first walkers' step."""

LOOK_UP_LATENCY = 1
"""Cycles from a winner's number to what is known of it."""


def rounds(config: Configuration) -> int:
    """Rounds in which the nearest of all rectangles is found, two by two; one alone has one too."""
    return max(1, (config.rectangles - 1).bit_length())


def winner_latency(config: Configuration) -> int:
    """Cycles from a pass's ray to the rectangle that it sees."""
    return tester.LATENCY + rounds(config) * contest.LATENCY


def pass_latency(config: Configuration) -> int:
    """Cycles from a ray to its reflection."""
    return winner_latency(config) + LOOK_UP_LATENCY + folder.LATENCY


def beam_latency(config: Configuration) -> int:
    """Cycles from a column's own, when next_column leaves it, to its colour."""
    return (
        ENTRY_LATENCY
        + config.reflections * pass_latency(config)
        + winner_latency(config)
        + LOOK_UP_LATENCY
        + blend.LATENCY
    )


def unfolded(config: Configuration) -> Fold:
    """The fold of a ray that has met no mirror."""
    fold = Fold(config)
    fold.back_x, fold.back_y, fold.back_z, fold.mirror_back, fold.active = (constant(0, 1) for _ in range(5))
    fold.turn_x, fold.turn_y, fold.turn_z = (signed_constant(0, TURN_BITS) for _ in range(3))
    fold.u_x, fold.u_y, fold.u_z, fold.v_x, fold.v_y, fold.v_z = (
        signed_constant(0, fold_bits(config)) for _ in range(6)
    )
    fold.border_x, fold.border_y, fold.border_z = (signed_constant(0, walk_bits(config)) for _ in range(3))
    fold.axis, fold.distance = constant(0, AXIS_BITS), signed_constant(0, DISTANCE_BITS)
    return fold


def mirror() -> Reflector:
    """One that a ray has left."""
    reflector = Reflector()
    reflector.active = constant(1, 1)
    return reflector


def no_mirror() -> Reflector:
    """That of a ray from the camera."""
    reflector = Reflector()
    reflector.active, reflector.axis = constant(0, 1), constant(0, AXIS_BITS)
    reflector.distance = signed_constant(0, DISTANCE_BITS)
    return reflector


def winner(config: Configuration) -> Candidate:
    """The last candidate, of which nobody asks any more how near it is."""
    candidate = Candidate(config)
    candidate.numerator = unconnected(len(candidate.numerator))
    candidate.denominator = unconnected(len(candidate.denominator))
    return candidate


@block
def beam_caster(
    clk,
    reset,
    start_line,
    next_column,
    row_slope,
    camera,
    background,
    reflections,
    rects,
    red,
    green,
    blue,
    config: Configuration,
):
    """The colours of a row, a column at each next_column, beam_latency cycles later.

    start_line: strobe; the first column's turn is no sooner than rect_setup takes, and the last column of the line
    before has left. row_slope: D[z], which holds still from the third cycle after start_line on. Each pass has a
    walker and a tester for each rectangle, and runs as much later than the one before it as the latencies that the
    blocks declare add up to.
    """
    count, passes = config.rectangles, config.reflections + 1
    slope_width = exact_slope_bits(config) + 1
    view_distance = config.screen_geometry.view_distance
    # The video generator's strobe has come a long way, so a register takes it before it goes everywhere.
    starts = [ENTRY_LATENCY + number * pass_latency(config) for number in range(passes)]
    step_count = starts[-1] + 2
    kept_bits = step_count - 1

    load = unsigned(count)
    new_facet, new_growth, new_start = Facet(config), Walk(DISTANCE_BITS), Walk(walk_bits(config))
    facets, growths = [Facet(config) for _ in range(count)], [Walk(DISTANCE_BITS) for _ in range(count)]
    steps = unsigned(step_count)

    setup = rect_setup(
        clk, reset, start_line, rects, camera, row_slope, load, new_facet, new_growth, new_start, config
    )  # fmt: skip
    memories = [
        facet_mem(clk, load(i + 1, i), new_facet, new_growth, facets[i], growths[i]) for i in range(count)
    ]  # fmt: skip

    # When a column has been as many cycles in the pipeline as the bit's number.
    @always(clk.posedge)
    def follow_columns():
        steps.next = concat(steps[kept_bits:], next_column)

    def step_after(cycles: int):
        return steps(cycles, cycles - 1)

    walks = [[Walk(walk_bits(config)) for _ in range(count)] for _ in range(passes)]
    walkers = [
        rect_walker(
            clk, load(i + 1, i), step_after(start), step_after(start + 1), new_start, growths[i], walks[number][i]
        )
        for number, start in enumerate(starts)
        for i in range(count)
    ]

    folds = [unfolded(config)] + [Fold(config) for _ in range(config.reflections)]
    for fold in folds[1:]:
        fold.active = constant(1, 1)
    early_slopes, late_slopes = ([signed(slope_width) for _ in range(passes)] for _ in range(2))
    slopes = [Slope(slope_width - 1) for _ in range(passes)]
    rays = [
        (
            slope_walker(clk, start_line, step_after(start), early_slopes[number], config),
            slope_walker(clk, start_line, step_after(start + 2), late_slopes[number], config),
            slope_magnitudes(late_slopes[number], row_slope, slopes[number]),
        )
        for number, start in enumerate(starts)
    ]

    hits = [[Candidate(config) for _ in range(count)] for _ in range(passes)]
    for candidates in hits:
        for i, candidate in enumerate(candidates):
            candidate.index = constant(i, index_bits(config))
    testers = [
        fold_tester(
            clk, facets[i], walks[number][i], early_slopes[number], row_slope, slopes[number], folds[number],
            hits[number][i], view_distance,
        )
        for number in range(passes)
        for i in range(count)
    ]  # fmt: skip

    # The rounds of each pass; the last has one candidate left.
    fields = [[candidates] for candidates in hits]
    contests = []
    for field in fields:
        for _ in range(rounds(config)):
            pairs = [field[-1][i : i + 2] for i in range(0, len(field[-1]), 2)]
            field.append([Candidate(config) if len(pairs) > 1 else winner(config) for _ in pairs])
            contests += [
                nearest_of_two(clk, *pair, nearest) if len(pair) == 2 else unopposed(clk, *pair, nearest)
                for pair, nearest in zip(pairs, field[-1], strict=True)
            ]
    winners = [field[-1][0] for field in fields]

    # What each pass saw, when the last one has seen something too; and on the way the mirrors of each fold.
    delays = []
    seen = [[last] for last in winners]
    for number, stages in enumerate(seen):
        for _ in range(number + 1, passes):
            stages.append(Candidate(config))
            delays.append(
                winner_delay(
                    clk, stages[-2].valid, stages[-2].index, stages[-1].valid, stages[-1].index, pass_latency(config)
                )
            )
    none, nothing = constant(0, index_bits(config)), constant(0, 1)
    index_0, index_1, index_2 = ([stages[-1].index for stages in seen] + [none, none])[:3]
    valid_0, valid_1, valid_2 = ([stages[-1].valid for stages in seen] + [nothing, nothing])[:3]

    axes, distances, colors = ([getattr(facet, name) for facet in facets] for name in ("axis", "distance", "colour"))
    found_0, found_1, found_2 = (bit() for _ in range(3))
    color_0, color_1, color_2 = (unsigned(COLOUR_BITS) for _ in range(3))

    # What is known of the rectangles that were seen.
    @always(clk.posedge)
    def look_up_colors():
        found_0.next = valid_0
        found_1.next = valid_1
        found_2.next = valid_2
        color_0.next = colors[index_0]
        color_1.next = colors[index_1]
        color_2.next = colors[index_2]

    blender = color_blend(
        clk, found_0, found_1, found_2, color_0, color_1, color_2, background, reflections, red, green, blue, config
    )
    common = setup, memories, follow_columns, walkers, rays, testers, contests, delays, look_up_colors, blender
    if passes == 1:
        return common

    looked_up = winner_latency(config) + LOOK_UP_LATENCY
    mirror_slopes = [signed(slope_width) for _ in range(config.reflections)]
    mirror_rays = [
        slope_walker(clk, start_line, step_after(start + looked_up + 1), slope, config)
        for start, slope in zip(starts, mirror_slopes, strict=False)
    ]
    nowhere, only = no_mirror(), mirror()
    only_index = seen[0][0].index

    # The mirror that the first reflection leaves.
    @always(clk.posedge)
    def look_up_mirror():
        only.axis.next = axes[only_index]
        only.distance.next = distances[only_index]

    first_folder = ray_fold(clk, nowhere, only, mirror_slopes[0], row_slope, folds[1], view_distance)
    if passes == 2:
        return (*common, mirror_rays, look_up_mirror, first_folder)

    earlier, last = mirror(), mirror()
    earlier_index, last_index = seen[0][1].index, seen[1][0].index

    # The mirrors that the second reflection has left.
    @always(clk.posedge)
    def look_up_mirrors():
        earlier.axis.next = axes[earlier_index]
        earlier.distance.next = distances[earlier_index]
        last.axis.next = axes[last_index]
        last.distance.next = distances[last_index]

    second_folder = ray_fold(clk, earlier, last, mirror_slopes[1], row_slope, folds[2], view_distance)
    return (*common, mirror_rays, look_up_mirror, first_folder, look_up_mirrors, second_folder)
