# SPDX-License-Identifier: MIT
"""The beam engine: every rectangle at once, a pixel a clock."""

from collections.abc import Mapping
from copy import copy

from myhdl import always, block, concat

from raycaster.configuration import Configuration
from raycaster.rtl.beam import fold_tester as tester
from raycaster.rtl.beam import nearest_of_two as contest
from raycaster.rtl.beam import ray_fold as folder
from raycaster.rtl.beam.facet_register import facet_register
from raycaster.rtl.beam.facet_rom import facet_rom
from raycaster.rtl.beam.fold_tester import fold_tester
from raycaster.rtl.beam.nearest_of_two import nearest_of_two
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.beam.slope_magnitudes import slope_magnitudes
from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.beam.unopposed import unopposed
from raycaster.rtl.beam.winner_delay import winner_delay
from raycaster.rtl.common.legacy import Candidate, Facet, Fold, Reflector, Slope, Walk
from raycaster.rtl.common.ties import Signed, Tied, tied, unconnected
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    DISTANCE_BITS,
    RGB_BITS,
    TURN_BITS,
    bit,
    exact_slope_bits,
    fold_bits,
    index_bits,
    signed,
    unsigned,
    walk_bits,
)
from raycaster.rtl.engine import colour_blend as blend
from raycaster.rtl.engine.colour_blend import colour_blend
from raycaster.rtl.engine.rect_setup import rect_setup

ENTRY_LATENCY = 1
"""Cycles from next_column to the first walkers' step."""

LOOK_UP_LATENCY = 1
"""Cycles from a winner's number to what is known of it."""


def tested(config: Configuration) -> list[list[int]]:
    """For the primary ray and each reflection, the numbers of the rectangles that it is tested against.

    A fixed scene may leave none for a reflection, which is then none; one rectangle is always tested.
    """
    return [[i for i in range(config.rectangles) if mask >> i & 1] for mask in config.passes if mask]


def rounds(config: Configuration) -> int:
    """Rounds in which the nearest of a pass's rectangles is found, two by two; one alone has one too."""
    most = max(mask.bit_count() for mask in config.passes)
    return max(1, (most - 1).bit_length())


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
        + (len(tested(config)) - 1) * pass_latency(config)
        + winner_latency(config)
        + LOOK_UP_LATENCY
        + blend.LATENCY
    )


def unfolded(config: Configuration) -> Fold:
    """The fold of a ray that has met no mirror."""
    fold = Fold(config)
    fold.back_x, fold.back_y, fold.back_z, fold.mirror_back, fold.active = (tied(0, 1) for _ in range(5))
    fold.turn_x, fold.turn_y, fold.turn_z = (tied(0, Signed(TURN_BITS)) for _ in range(3))
    fold.u_x, fold.u_y, fold.u_z, fold.v_x, fold.v_y, fold.v_z = (tied(0, Signed(fold_bits(config))) for _ in range(6))
    fold.border_x, fold.border_y, fold.border_z = (tied(0, Signed(walk_bits(config))) for _ in range(3))
    fold.axis, fold.distance = tied(0, AXIS_BITS), tied(0, Signed(DISTANCE_BITS))
    return fold


def mirror() -> Reflector:
    """One that a ray has left."""
    reflector = Reflector()
    reflector.active = tied(1, 1)
    return reflector


def no_mirror() -> Reflector:
    """That of a ray from the camera."""
    reflector = Reflector()
    reflector.active, reflector.axis = tied(0, 1), tied(0, AXIS_BITS)
    reflector.distance = tied(0, Signed(DISTANCE_BITS))
    return reflector


def fix_facet(facet: Facet, number: int, config: Configuration) -> None:
    """Hold what is known of a rectangle of a fixed scene."""
    rectangle = config.fixed.rectangles[number]
    known = {"usable": 1, "axis": rectangle.axis, "colour": rectangle.colour}
    if config.fixed.camera:
        known["distance"] = config.fixed.distances[number]
    hold(facet, known)


def fix_growth(growth: Walk, number: int, config: Configuration) -> None:
    """The same for its growth: along a row either its way along u grows, or its bounds do, as rect_setup has it."""
    rectangle, camera = config.fixed.rectangles[number], config.fixed.camera
    bounds = {"low_u": (rectangle.u_low, 0), "high_u": (rectangle.u_high, 0)}
    bounds |= {"low_v": (rectangle.v_low, 2), "high_v": (rectangle.v_high, 2)}
    known = {"way_u": 0} if rectangle.axis == 1 else dict.fromkeys(bounds, 0)
    if camera and rectangle.axis == 1:
        known |= {name: bound - camera[axis] for name, (bound, axis) in bounds.items()}
    elif camera:
        known["way_u"] = config.fixed.distances[number]
    hold(growth, known)


def hold(group, known: Mapping[str, int]) -> None:
    """Make some signals of a group ones that never change."""
    for name, value in known.items():
        setattr(group, name, tied(value, getattr(group, name)))


def driven(group):
    """The same group for what drives the rest of it."""
    shown = copy(group)
    for name, signal in vars(group).items():
        if isinstance(signal, Tied):
            setattr(shown, name, unconnected(signal))
    return shown


def unread_mirror() -> Reflector:
    """One that nobody asks for."""
    reflector = Reflector()
    reflector.distance = unconnected(reflector.distance)
    return reflector


def table_distance(reflector: Reflector, config: Configuration):
    """A mirror's distance where a table has it."""
    return reflector.distance if config.fixed.camera else None


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
    count, numbers = config.rectangles, tested(config)
    passes = len(numbers)
    slope_width = exact_slope_bits(config) + 1
    view_distance = config.screen_geometry.view_distance
    # The video generator's strobe has come a long way, so a register takes it before it goes everywhere.
    starts = [ENTRY_LATENCY + number * pass_latency(config) for number in range(passes)]
    step_count = starts[-1] + 2
    kept_bits = step_count - 1

    load = unsigned(count)
    new_facet, new_growth, new_start = Facet(config), Walk(DISTANCE_BITS), Walk(walk_bits(config))
    facets, growths = [Facet(config) for _ in range(count)], [Walk(DISTANCE_BITS) for _ in range(count)]
    if config.fixed:
        for i in range(count):
            fix_facet(facets[i], i, config)
            fix_growth(growths[i], i, config)
    steps = unsigned(step_count)

    first_slope = tied(-config.screen_geometry.centre_column, signed(slope_width))
    setup = rect_setup(
        clk, reset, start_line, rects, camera, first_slope, row_slope, load, new_facet, new_growth, new_start, config
    )
    memories = [
        facet_register(clk, load(i + 1, i), new_facet, new_growth, driven(facets[i]), driven(growths[i]))
        for i in range(count)
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
        for i in numbers[number]
    ]

    folds = [unfolded(config)] + [Fold(config) for _ in range(1, passes)]
    for fold in folds[1:]:
        fold.active = tied(1, 1)
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
            candidate.index = tied(i, index_bits(config))
    testers = [
        fold_tester(
            clk, facets[i], walks[number][i], early_slopes[number], row_slope, slopes[number], folds[number],
            hits[number][i], view_distance,
        )
        for number in range(passes)
        for i in numbers[number]
    ]  # fmt: skip

    # The rounds of each pass; the last has one candidate left.
    fields = [[[candidates[i] for i in tried]] for candidates, tried in zip(hits, numbers, strict=True)]
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
    none, nothing = tied(0, index_bits(config)), tied(0, 1)
    index_0, index_1, index_2 = ([stages[-1].index for stages in seen] + [none, none])[:3]
    valid_0, valid_1, valid_2 = ([stages[-1].valid for stages in seen] + [nothing, nothing])[:3]

    axes, distances, colours = ([getattr(facet, name) for facet in facets] for name in ("axis", "distance", "colour"))
    found_0, found_1, found_2 = (bit() for _ in range(3))
    colour_0, colour_1, colour_2 = (unsigned(RGB_BITS) for _ in range(3))

    # Which rays met anything.
    @always(clk.posedge)
    def look_up_hits():
        found_0.next = valid_0
        found_1.next = valid_1
        found_2.next = valid_2

    # What they met.
    @always(clk.posedge)
    def look_up_colours():
        colour_0.next = colours[index_0]
        colour_1.next = colours[index_1]
        colour_2.next = colours[index_2]

    colour_look_ups = look_up_colours
    if config.fixed:
        colour_look_ups = [
            facet_rom(clk, index, unconnected(AXIS_BITS), table_distance(unread_mirror(), config), colour, config)
            for index, colour in ((index_0, colour_0), (index_1, colour_1), (index_2, colour_2))
        ]

    blender = colour_blend(
        clk, found_0, found_1, found_2, colour_0, colour_1, colour_2, background, reflections, red, green, blue, config
    )
    common = (
        setup, memories, follow_columns, walkers, rays, testers, contests, delays, look_up_hits, colour_look_ups,
        blender,
    )  # fmt: skip
    if passes == 1:
        return common

    looked_up = winner_latency(config) + LOOK_UP_LATENCY
    mirror_slopes = [signed(slope_width) for _ in range(1, passes)]
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

    # Of a fixed one, only the distance is not known.
    @always(clk.posedge)
    def look_up_distance():
        only.distance.next = distances[only_index]

    first_look_up = look_up_mirror
    if config.fixed:
        tables = [facet_rom(clk, only_index, only.axis, table_distance(only, config), unconnected(RGB_BITS), config)]
        first_look_up = tables if config.fixed.camera else (tables, look_up_distance)
    first_folder = ray_fold(clk, nowhere, only, mirror_slopes[0], row_slope, folds[1], view_distance)
    if passes == 2:
        return (*common, mirror_rays, first_look_up, first_folder)

    earlier, last = mirror(), mirror()
    earlier_index, last_index = seen[0][1].index, seen[1][0].index

    # The mirrors that the second reflection has left.
    @always(clk.posedge)
    def look_up_mirrors():
        earlier.axis.next = axes[earlier_index]
        earlier.distance.next = distances[earlier_index]
        last.axis.next = axes[last_index]
        last.distance.next = distances[last_index]

    # Of fixed ones, only the distances are not known.
    @always(clk.posedge)
    def look_up_distances():
        earlier.distance.next = distances[earlier_index]
        last.distance.next = distances[last_index]

    second_look_up = look_up_mirrors
    if config.fixed:
        tables = [
            facet_rom(clk, index, left.axis, table_distance(left, config), unconnected(RGB_BITS), config)
            for index, left in ((earlier_index, earlier), (last_index, last))
        ]
        second_look_up = tables if config.fixed.camera else (tables, look_up_distances)
    second_folder = ray_fold(clk, earlier, last, mirror_slopes[1], row_slope, folds[2], view_distance)
    return (*common, mirror_rays, first_look_up, first_folder, second_look_up, second_folder)
