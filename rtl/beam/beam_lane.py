# SPDX-License-Identifier: MIT
"""A lane of the beam engine: all that a column goes through, from a row's start to its pixel."""

from itertools import pairwise

from myhdl import always, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.beam import hit_cells as cells
from raycaster.rtl.beam import ray_fold as folder
from raycaster.rtl.beam.beam_pass import beam_pass, winner_latency
from raycaster.rtl.beam.fold_tester import fold_lead
from raycaster.rtl.beam.hit_cells import hit_cells
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.slope_walker import ray_slope, slope_walker
from raycaster.rtl.beam.winner_delay import winner_delay
from raycaster.rtl.beam.word_of import word_of
from raycaster.rtl.common.records import (
    Look,
    Reflector,
    Sight,
    candidate_of,
    facet_of,
    fold_of,
    winner_of,
)
from raycaster.rtl.common.widths import RGB_BITS, bit, index_bits, unsigned
from raycaster.rtl.engine.colour_blend import blend_latency, blends_three, colour_blend, mixes
from raycaster.rtl.engine.pattern_colour import pattern_colour

ENTRY_LATENCY = 1
"""Cycles from next_column to the first walkers' step."""

LOOK_UP_LATENCY = 1
"""Cycles from a winner's number to what is known of it."""


def tested(config: Configuration) -> list[list[int]]:
    """For the primary ray and each reflection, the numbers of the rectangles that it is tested against.

    A fixed scene may leave none for a reflection, which is then none; one rectangle is always tested.
    """
    return [[i for i in range(config.rectangles) if mask >> i & 1] for mask in config.passes if mask]


def pass_latency(config: Configuration) -> int:
    """Cycles from a ray to its reflection."""
    return winner_latency(config) + LOOK_UP_LATENCY + folder.LATENCY + fold_lead(config)


def cell_latency(config: Configuration) -> int:
    """Cycles from a winner to the cells of its pattern that it is hit in."""
    return cells.LATENCY if config.patterns else 0


def beam_latency(config: Configuration) -> int:
    """Cycles from next_column to the column's colour."""
    reflections = len(tested(config)) - 1
    entered = ENTRY_LATENCY + reflections * pass_latency(config)
    return entered + winner_latency(config) + cell_latency(config) + LOOK_UP_LATENCY + blend_latency(config)


@block
def beam_lane(
    clk, start_line, next_column, enter, load, start, aim, facets, growths, camera, picture, pixel,
    config: Configuration,
):  # fmt: skip
    """A column at each next_column; its pixel follows beam_latency cycles later.

    Each pass runs as much later than the one before it as the latencies that the blocks declare add up to. enter: where
    the camera turns, a strobe in the cycle before what walks along the row takes its start; then next_column is low,
    and growths and aim are the start. load, start, aim, facets, growths: as in `beam_pass`.
    """
    numbers = tested(config)
    passes, reflections = len(numbers), len(numbers) - 1
    starts = [ENTRY_LATENCY + number * pass_latency(config) for number in range(passes)]
    looked_up = winner_latency(config) + LOOK_UP_LATENCY
    seen = starts[-1] + winner_latency(config) + cell_latency(config)
    every_step = (1 << seen) - 1
    facet = facet_of(config)
    facet_words = [facet.twin().word for _ in range(config.rectangles)]
    takers = [word_of(facet_of(config).cut(facets, i), word) for i, word in enumerate(facet_words)]

    # Bit i: a column was announced i + 1 cycles ago. next_column comes a long way, so it is registered before its use.
    steps = unsigned(seen)

    if config.turn:
        # All that walks along a row starts from 0, by a step that is as long as the start; its steps are growth then.
        entered, restart = bit(), bit()

        @always(clk.posedge)
        def follow_columns():
            # It resets all that walks, all over the chip.
            restart.next = start_line
            entered.next = enter
            if enter:
                steps.next = every_step
            elif entered:
                steps.next = 0
            else:
                steps.next = concat(steps[seen - 1 :], next_column)

    else:
        restart = start_line

        @always(clk.posedge)
        def follow_columns():
            steps.next = concat(steps[seen - 1 :], next_column)

    def step_after(cycles: int):
        return steps(cycles, cycles - 1)

    folds, winners = [fold_of(config) for _ in numbers], [winner_of(config) for _ in numbers]
    hits = [candidate_of(config) if config.patterns else None for _ in numbers]
    folds[0].tie({})
    beams = [
        beam_pass(clk, start_line=restart, load=load, step=step_after(first),
            step_way=step_after(first + (fold is None)), step_bounds=step_after(first + 1),
            step_slope=step_after(first + 2), start=start, aim=aim, facets=facets, growths=growths, fold=fold,
            nearest=hit, winner=winner, tested=some, config=config)
        for first, fold, hit, winner, some in zip(starts, [None, *folds[1:]], hits, winners, numbers, strict=True)
    ]  # fmt: skip

    # The slope of a ray that has just got its winner: for its fold at the mirror, and for the pattern that it sees.
    late_slopes = [ray_slope(aim, config) for _ in range(passes if config.patterns else reflections)]
    late_walkers = [
        slope_walker(clk, restart, step_after(first + looked_up + 1), aim=aim, slope=slope, config=config)
        for first, slope in zip(starts, late_slopes, strict=False)
    ]
    if config.patterns:
        sights = [Sight(index_bits(config)) for _ in numbers]
        cell_finders = [
            hit_cells(
                clk, fold=fold, nearest=hit, winner=winner, slope=slope, camera=camera, sight=sight, config=config
            )
            for fold, hit, winner, slope, sight in zip(folds, hits, winners, late_slopes, sights, strict=True)
        ]
    else:
        sights = winners

    # What each pass sees, and the same delayed until the last pass sees something too.
    stages = [[one, *(one.twin() for _ in sights[number:])] for number, one in enumerate(sights, 1)]
    delays = [
        winner_delay(clk, now.word, late.word, pass_latency(config)) for one in stages for now, late in pairwise(one)
    ]
    # A reflection that the design does not have meets nothing.
    none, nothing = (sights[0].twin().tie({}) for _ in range(2))
    end_0, end_1, end_2 = ([one[-1] for one in stages] + [none, nothing])[:3]
    found_0, found_1, found_2 = (bit() for _ in range(3))
    look_0, look_1, look_2 = (Look(config.materials, config.patterns) for _ in range(3))
    colour_0, colour_1, colour_2 = look_0.colour, look_1.colour, look_2.colour
    look_bits = len(look_0.word)

    # What is between two columns' steps is of neither: a column that is more than a clock wide keeps what it has seen.
    step_seen = step_after(seen)

    @always(clk.posedge)
    def look_up():
        if step_seen:
            found_0.next = end_0.valid
            found_1.next = end_1.valid
            look_0.word.next = facet_words[end_0.index][look_bits:]
            look_1.word.next = facet_words[end_1.index][look_bits:]

    if config.patterns:
        odd_u_0, odd_v_0, odd_u_1, odd_v_1 = (bit() for _ in range(4))
        colour_0, colour_1 = unsigned(RGB_BITS), unsigned(RGB_BITS)
        painters = [
            pattern_colour(look_0, odd_u=odd_u_0, odd_v=odd_v_0, colour=colour_0),
            pattern_colour(look_1, odd_u=odd_u_1, odd_v=odd_v_1, colour=colour_1),
        ]

        @always(clk.posedge)
        def follow_cells():
            if step_seen:
                odd_u_0.next = end_0.odd_u
                odd_v_0.next = end_0.odd_v
                odd_u_1.next = end_1.odd_u
                odd_v_1.next = end_1.odd_v

    if blends_three(config):

        @always(clk.posedge)
        def look_up_last():
            if step_seen:
                found_2.next = end_2.valid
                look_2.word.next = facet_words[end_2.index][look_bits:]

        if config.patterns:
            odd_u_2, odd_v_2, colour_2 = bit(), bit(), unsigned(RGB_BITS)
            last_painter = pattern_colour(look_2, odd_u=odd_u_2, odd_v=odd_v_2, colour=colour_2)

            @always(clk.posedge)
            def follow_last_cells():
                if step_seen:
                    odd_u_2.next = end_2.odd_u
                    odd_v_2.next = end_2.odd_v

    else:
        found_2 = colour_2 = None
    mirror_0 = look_0.mirror if mixes(config) else None
    mirror_1 = look_1.mirror if mixes(config) and config.reflections == 2 else None

    blender = colour_blend(
        clk, found_0=found_0, found_1=found_1, found_2=found_2, colour_0=colour_0, colour_1=colour_1, colour_2=colour_2,
        mirror_0=mirror_0, mirror_1=mirror_1, picture=picture, pixel=pixel, config=config,
    )  # fmt: skip

    # Of a facet, a reflector has the axis and the distance, which are next to each other in both.
    mirror_end, mirror_low = facet.slice("axis")[0] + 1, facet.slice("distance")[1]
    if passes > 1:
        first_winner, no_mirror, only = winners[0], Reflector().tie({}), Reflector()

        @always(clk.posedge)
        def look_up_mirror():
            only.word.next = concat(True, False, facet_words[first_winner.index][mirror_end:mirror_low])

        first_folder = ray_fold(clk, earlier=no_mirror, last=only, slope=late_slopes[0], fold=folds[1])
    if passes > 2:
        late_winner, second_winner, earlier, last = stages[0][1], winners[1], Reflector(), Reflector()
        if config.patterns:
            # The first sight is later than its winner, by as long as it takes to find its cells.
            late_winner = winner_of(config)
            first_delay = winner_delay(clk, first_winner.word, late_winner.word, pass_latency(config))

        @always(clk.posedge)
        def look_up_mirrors():
            earlier.word.next = concat(True, False, facet_words[late_winner.index][mirror_end:mirror_low])
            last.word.next = concat(
                True, second_winner.at_mirror, facet_words[second_winner.index][mirror_end:mirror_low]
            )

        second_folder = ray_fold(clk, earlier=earlier, last=last, slope=late_slopes[1], fold=folds[2])

    return instances()
