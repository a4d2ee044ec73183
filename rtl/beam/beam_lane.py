# SPDX-License-Identifier: MIT
"""A lane of the beam engine: the whole pipeline of a column, from a row's start to its pixel."""

from itertools import pairwise

from myhdl import always, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, side_by_side, unsigned
from raycaster.rtl.beam.beam_pass import beam_pass
from raycaster.rtl.beam.colour_blend import colour_blend
from raycaster.rtl.beam.hit_cells import hit_cells
from raycaster.rtl.beam.latencies import (
    ENTRY_LATENCY,
    LOOK_UP_LATENCY,
    cell_latency,
    fold_lead,
    pass_latency,
    tested,
    winner_latency,
)
from raycaster.rtl.beam.look_up import look_up
from raycaster.rtl.beam.mirror_look_up import mirror_look_up
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.slope_walker import ray_slope, slope_walker
from raycaster.rtl.common.delay_line import delay_line
from raycaster.rtl.common.records import Candidate, Fold, Reflector, RoomImage, Seen, Sight, Winner


@block
def beam_lane(
    clk, start_line, next_column, enter, load, start, aim, facets, growths, camera, picture, pixel,
    config: Configuration,
):  # fmt: skip
    """Compute a column at each next_column; its pixel follows `beam_latency` cycles later.

    Each pass runs later than the one before it by the sum of the latencies that the blocks declare.

    Args:
        clk: the clock.
        start_line: strobe; begins a line.
        next_column: strobe; begins a column.
        enter: strobe, read if the camera turns. In the next cycle, growths and aim are the start values, and everything
            that walks along the row takes them; next_column is low in both cycles.
        load: `config.rectangles` bits, high for the rectangle that start belongs to; not read if the camera turns:
            start_line then loads all of them.
        start: `Walk`; the start of the rectangle that load names, for the first column of this lane. 0 if the camera
            turns.
        aim: `Vector`; D of the first column of this lane or, if the camera turns, the change of D per step.
        facets: `Facet` of each rectangle, side by side, the first in the lowest bits.
        growths: the change per step of each rectangle's `Walk`, side by side, the first in the lowest bits.
        camera: `Camera` of the live scene.
        picture: `Picture` of the live scene; run is not read.
        pixel: `Pixel`; output, `beam_latency` cycles after next_column.
        config: the design.
    """
    numbers = tested(config)
    passes, reflections = len(numbers), len(numbers) - 1
    starts = [ENTRY_LATENCY + number * pass_latency(config) for number in range(passes)]
    looked_up = winner_latency(config) + LOOK_UP_LATENCY
    look_up_at = starts[-1] + winner_latency(config) + cell_latency(config)
    every_step = (1 << look_up_at) - 1

    # Bit i: a column was announced i + 1 cycles ago. next_column has a long route, so it is registered before its use.
    steps = unsigned(look_up_at)

    if config.turn:
        # Everything that walks along a row starts at 0, and its first step is the start value; later steps are growth.
        entered, restart = bit(), bit()

        @always(clk.posedge)
        def follow_columns():
            # restart goes to all walkers, all over the chip, so it is registered.
            restart.next = start_line
            entered.next = enter
            if enter:
                steps.next = every_step
            elif entered:
                steps.next = 0
            else:
                steps.next = concat(steps[look_up_at - 1 :], next_column)

    else:
        restart = start_line

        @always(clk.posedge)
        def follow_columns():
            steps.next = concat(steps[look_up_at - 1 :], next_column)

    def step_after(cycles: int):
        return steps(cycles, cycles - 1)

    folds = [Fold(config).tie({}), *(Fold(config) for _ in range(reflections))]
    winners = [Winner(config) for _ in numbers]
    hits = [Candidate(config) if config.patterns else Candidate(config).left_open() for _ in numbers]
    beams = [
        beam_pass(clk, start_line=restart, load=load, step=step_after(first),
            step_way=step_after(first + (not reflected)), step_bounds=step_after(first + 1),
            step_slope=step_after(first + 2), start=start, aim=aim, facets=facets, growths=growths, fold=fold,
            nearest=hit, winner=winner, tested=some, reflected=reflected, config=config)
        for first, fold, hit, winner, some, reflected in zip(
            starts, folds, hits, winners, numbers, [False] + [True] * reflections, strict=True
        )
    ]  # fmt: skip

    # The slope of a ray whose winner was just found: for its fold at the mirror, and for the pattern that it sees.
    late_slopes = [ray_slope(aim, config) for _ in range(passes if config.patterns else reflections)]
    late_walkers = [
        slope_walker(clk, restart, step_after(first + looked_up + 1), aim=aim, slope=slope, config=config)
        for first, slope in zip(starts, late_slopes, strict=False)
    ]
    # The image of the room that a ray is in, at the time when its hit is known.
    images = [RoomImage(config).tie({}), *(RoomImage(config) for _ in range(reflections))]

    if config.patterns:
        sights = [Sight(config) for _ in numbers]
        cell_finders = [
            hit_cells(
                clk, image=image, nearest=hit, winner=winner, slope=slope, camera=camera, sight=sight, config=config
            )
            for image, hit, winner, slope, sight in zip(images, hits, winners, late_slopes, sights, strict=True)
        ]
    else:
        sights = winners

    # The sight of each pass, delayed until that of the last pass is known.
    stages = [[one, *(one.twin() for _ in sights[number:])] for number, one in enumerate(sights, 1)]
    delays = [
        delay_line(clk, now.word, late.word, pass_latency(config)) for one in stages for now, late in pairwise(one)
    ]
    # The last ray's image is used only for its pattern.
    image_delays = [
        delay_line(clk, fold.image, image.word, fold_lead(config) + looked_up)
        for fold, image in zip(folds[1:], images[1:], strict=True)
        if config.patterns or fold is not folds[-1]
    ]

    # Values between the steps of two columns belong to neither: a column of several clocks keeps its own until the next
    # step.
    step_look_up = step_after(look_up_at)

    sees = [Seen(config) for _ in numbers]
    look_ups = [
        look_up(clk, step_look_up, facets=facets, sight=one[-1], seen=seen, config=config)
        for one, seen in zip(stages, sees, strict=True)
    ]
    # A reflection without a pass sees nothing.
    missing = ["0" * len(Seen(config).word)] * (config.reflections - reflections)
    all_seen = side_by_side([*(seen.word for seen in sees), *missing])
    blender = colour_blend(clk, seen=all_seen, picture=picture, pixel=pixel, config=config)

    lasts = [Reflector() for _ in range(reflections)]
    mirrors = [
        mirror_look_up(clk, facets=facets, winner=winner, last=last, config=config)
        for winner, last in zip(winners, lasts, strict=False)
    ]
    folders = [
        ray_fold(clk, before=image, last=last, slope=slope, fold=fold)
        for image, last, slope, fold in zip(images, lasts, late_slopes, folds[1:], strict=False)
    ]

    return instances()
