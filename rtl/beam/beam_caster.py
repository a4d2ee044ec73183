# SPDX-License-Identifier: MIT
"""The beam engine: every rectangle at once, a pixel a clock."""

from collections.abc import Mapping
from itertools import pairwise

from myhdl import always, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.beam import hit_cells as cells
from raycaster.rtl.beam import ray_fold as folder
from raycaster.rtl.beam.beam_pass import beam_pass, winner_latency
from raycaster.rtl.beam.fold_tester import fold_lead
from raycaster.rtl.beam.hit_cells import hit_cells
from raycaster.rtl.beam.line_starter import line_starter
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.row_register import row_register
from raycaster.rtl.beam.slope_walker import ray_slope, slope_walker
from raycaster.rtl.beam.winner_delay import winner_delay
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.records import (
    Look,
    Record,
    Reflector,
    Sight,
    candidate_of,
    facet_of,
    fold_of,
    growth_of,
    walk_of,
    winner_of,
)
from raycaster.rtl.common.ties import Tied, tied
from raycaster.rtl.common.widths import RGB_BITS, bit, exact_slope_bits, index_bits, side_by_side, unsigned
from raycaster.rtl.engine.colour_blend import blend_latency, blends_three, colour_blend, mixes
from raycaster.rtl.engine.pattern_colour import pattern_colour
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


def known_facet(number: int, config: Configuration) -> dict[str, int]:
    """What is known of a rectangle's facet: nothing, but of a fixed scene."""
    if config.fixed is None:
        return {}
    rectangle = config.fixed.rectangles[number]
    distance = {"distance": config.fixed.distances[number]} if config.fixed.camera else {}
    look = {name: getattr(rectangle, name) for name in Look(config.materials, config.patterns).layout}
    return {"usable": 1, "axis": rectangle.axis, **look, **distance}


def known_growth(number: int, config: Configuration) -> dict[str, int]:
    """The same for its growth: along a row either its way along p grows, or its bounds do, as rect_setup has it.

    Where the camera turns, a row's start passes through.
    """
    if config.fixed is None or config.turn:
        return {}
    rectangle, camera = config.fixed.rectangles[number], config.fixed.camera
    bounds = {"low_p": (rectangle.u_low, 0), "high_p": (rectangle.u_high, 0)}
    bounds |= {"low_q": (rectangle.v_low, 2), "high_q": (rectangle.v_high, 2)}
    known = {"way_p": 0} if rectangle.axis == 1 else dict.fromkeys(bounds, 0)
    if camera and rectangle.axis == 1:
        known |= {name: bound - camera[axis] for name, (bound, axis) in bounds.items()}
    elif camera:
        known["way_p"] = config.fixed.distances[number]
    return known


def fixing(record: Record, known: Mapping[str, int]) -> dict[str, Tied]:
    """A row_register's ports for a record of which these fields' values are known."""
    live = {name: -1 for name in record.layout if name not in known}
    return {"live": tied(record.pack(live), record.word), "known": tied(record.pack(known), record.word)}


@block
def beam_caster(clk, reset, start_line, next_column, row_slope, camera, picture, rects, pixel, config: Configuration):
    """The pixels of a row, a column at each next_column, beam_latency cycles later.

    start_line: strobe; the first next_column is no sooner than `start_cycles`, and the last column of the line before
    has left. row_slope: rows above the horizon, constant from the third cycle after start_line on. Each pass runs as
    much later than the one before it as the latencies that the blocks declare add up to.
    """
    numbers = tested(config)
    passes, reflections = len(numbers), len(numbers) - 1
    centre_column, view_distance = config.screen_geometry.centre_column, config.screen_geometry.view_distance
    starts = [ENTRY_LATENCY + number * pass_latency(config) for number in range(passes)]
    looked_up = winner_latency(config) + LOOK_UP_LATENCY
    kept_bits = starts[-1] + (looked_up if config.patterns else 1)
    every_step = (2 << kept_bits) - 1

    load, last_rectangle = unsigned(config.rectangles), config.rectangles - 1
    new_facet, new_growth, new_start = facet_of(config), growth_of(config), walk_of(config)
    facets = [facet_of(config) for _ in range(config.rectangles)]
    facet_words = [facet.word for facet in facets]
    growth_words = [[unsigned(bits) for bits in new_growth.layout.values()] for _ in facets]
    all_facets = side_by_side(facet_words)
    all_growths = side_by_side([word for words in growth_words for word in reversed(words)])
    aim = Direction(exact_slope_bits(config) + 1)

    # Bit i: a column was announced i + 1 cycles ago. next_column comes a long way, so it is registered before its use.
    steps = unsigned(kept_bits + 1)

    if config.turn:
        # All that walks along a row starts from 0, by a step that is as long as the start; its steps are growth then.
        start_sweep, enter, entered, restart = bit(), bit(), bit(), bit()
        walk_start, walk_load, grown = walk_of(config).tie({}), None, new_start
        starter = line_starter(
            clk, reset, start_line=start_line, camera=camera, row_slope=row_slope, loaded=load(last_rectangle), aim=aim,
            start_sweep=start_sweep, enter=enter, config=config,
        )  # fmt: skip
        setup = rect_setup(
            clk, reset, start_line=start_sweep, rects=rects, camera=camera, slope=aim, load=load, facet=new_facet,
            growth=None, start=new_start, config=config,
        )  # fmt: skip

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
                steps.next = concat(steps[kept_bits:], next_column)

    else:
        aim.x, aim.y, aim.z = tied(view_distance, aim.x), tied(-centre_column, aim.y), row_slope
        walk_start, walk_load, grown, restart = new_start, load, new_growth, start_line
        setup = rect_setup(
            clk, reset, start_line=start_line, rects=rects, camera=camera, slope=aim, load=load, facet=new_facet,
            growth=new_growth, start=new_start, config=config,
        )  # fmt: skip

        @always(clk.posedge)
        def follow_columns():
            steps.next = concat(steps[kept_bits:], next_column)

    facet_registers = [
        row_register(clk, load(i + 1, i), new_facet.word, word=word, **fixing(new_facet, known_facet(i, config)))
        for i, word in enumerate(facet_words)
    ]
    # A register a field: a simulator need not take words apart to add growth in every column.
    growth_registers = [
        row_register(clk, load(i + 1, i), grown.word(grown.slice(name)[0] + 1, grown.slice(name)[1]), word=word,
            **fixing(Record({name: bits}), known_growth(i, config)))
        for i, words in enumerate(growth_words)
        for (name, bits), word in zip(grown.layout.items(), words, strict=True)
    ]  # fmt: skip

    def step_after(cycles: int):
        return steps(cycles, cycles - 1)

    folds, winners = [fold_of(config) for _ in numbers], [winner_of(config) for _ in numbers]
    hits = [candidate_of(config) if config.patterns else None for _ in numbers]
    folds[0].tie({})
    beams = [
        beam_pass(clk, start_line=restart, load=walk_load, step=step_after(first),
            step_way=step_after(first + (fold is None)), step_bounds=step_after(first + 1),
            step_slope=step_after(first + 2), start=walk_start, aim=aim, facets=all_facets, growths=all_growths,
            fold=fold, nearest=hit, winner=winner, tested=some, config=config)
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

    @always(clk.posedge)
    def look_up():
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
            odd_u_0.next = end_0.odd_u
            odd_v_0.next = end_0.odd_v
            odd_u_1.next = end_1.odd_u
            odd_v_1.next = end_1.odd_v

    if blends_three(config):

        @always(clk.posedge)
        def look_up_last():
            found_2.next = end_2.valid
            look_2.word.next = facet_words[end_2.index][look_bits:]

        if config.patterns:
            odd_u_2, odd_v_2, colour_2 = bit(), bit(), unsigned(RGB_BITS)
            last_painter = pattern_colour(look_2, odd_u=odd_u_2, odd_v=odd_v_2, colour=colour_2)

            @always(clk.posedge)
            def follow_last_cells():
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
    mirror_end, mirror_low = new_facet.slice("axis")[0] + 1, new_facet.slice("distance")[1]
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
