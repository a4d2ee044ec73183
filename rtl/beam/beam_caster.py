# SPDX-License-Identifier: MIT
"""The beam engine: every rectangle at once, a pixel a clock."""

from collections.abc import Mapping
from itertools import pairwise

from myhdl import always, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.beam import ray_fold as folder
from raycaster.rtl.beam.beam_pass import beam_pass, winner_latency
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.beam.row_register import row_register
from raycaster.rtl.beam.slope_walker import slope_walker
from raycaster.rtl.beam.winner_delay import winner_delay
from raycaster.rtl.common.records import Facet, Record, Reflector, Walk, Winner, fold_of
from raycaster.rtl.common.ties import Tied, tied
from raycaster.rtl.common.widths import (
    DISTANCE_BITS,
    RGB_BITS,
    bit,
    exact_slope_bits,
    index_bits,
    side_by_side,
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


def pass_latency(config: Configuration) -> int:
    """Cycles from a ray to its reflection."""
    return winner_latency(config) + LOOK_UP_LATENCY + folder.LATENCY


def beam_latency(config: Configuration) -> int:
    """Cycles from next_column to the column's colour."""
    reflections = len(tested(config)) - 1
    entered = ENTRY_LATENCY + reflections * pass_latency(config)
    return entered + winner_latency(config) + LOOK_UP_LATENCY + blend.LATENCY


def known_facet(number: int, config: Configuration) -> dict[str, int]:
    """What is known of a rectangle's facet: nothing, but of a fixed scene."""
    if config.fixed is None:
        return {}
    rectangle = config.fixed.rectangles[number]
    distance = {"distance": config.fixed.distances[number]} if config.fixed.camera else {}
    return {"usable": 1, "axis": rectangle.axis, "colour": rectangle.colour, **distance}


def known_growth(number: int, config: Configuration) -> dict[str, int]:
    """The same for its growth: along a row either its way along p grows, or its bounds do, as rect_setup has it."""
    if config.fixed is None:
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

    start_line: strobe; the first next_column is no sooner than rect_setup takes, and the last column of the line before
    has left. row_slope: D[z], constant from the third cycle after start_line on. Each pass runs as much later than the
    one before it as the latencies that the blocks declare add up to.
    """
    numbers = tested(config)
    passes, slope_width = len(numbers), exact_slope_bits(config) + 1
    view_distance = config.screen_geometry.view_distance
    starts = [ENTRY_LATENCY + number * pass_latency(config) for number in range(passes)]
    kept_bits = starts[-1] + 1

    load = unsigned(config.rectangles)
    new_facet, new_growth, new_start = Facet(walk_bits(config)), Walk(DISTANCE_BITS), Walk(walk_bits(config))
    facets = [Facet(walk_bits(config)) for _ in range(config.rectangles)]
    growths = [Walk(DISTANCE_BITS) for _ in range(config.rectangles)]
    facet_words, growth_words = [facet.word for facet in facets], [growth.word for growth in growths]
    all_facets, all_growths = side_by_side(facet_words), side_by_side(growth_words)

    setup = rect_setup(
        clk, reset, start_line=start_line, rects=rects, camera=camera, row_slope=row_slope, load=load,
        column_slope=tied(-config.screen_geometry.centre_column, signed(slope_width)),
        facet=new_facet, growth=new_growth, start=new_start, config=config,
    )  # fmt: skip
    facet_registers = [
        row_register(clk, load(i + 1, i), new_facet.word, word=word, **fixing(new_facet, known_facet(i, config)))
        for i, word in enumerate(facet_words)
    ]
    growth_registers = [
        row_register(clk, load(i + 1, i), new_growth.word, word=word, **fixing(new_growth, known_growth(i, config)))
        for i, word in enumerate(growth_words)
    ]

    # Bit i: a column was announced i + 1 cycles ago. next_column comes a long way, so it is registered before its use.
    steps = unsigned(kept_bits + 1)

    @always(clk.posedge)
    def follow_columns():
        steps.next = concat(steps[kept_bits:], next_column)

    def step_after(cycles: int):
        return steps(cycles, cycles - 1)

    folds, winners = [fold_of(config) for _ in numbers], [Winner(index_bits(config)) for _ in numbers]
    folds[0].tie({})
    beams = [
        beam_pass(clk, start_line=start_line, load=load, step=step_after(first), step_bounds=step_after(first + 1),
            step_slope=step_after(first + 2), start=new_start, row_slope=row_slope, facets=all_facets,
            growths=all_growths, fold=fold, winner=winner, tested=some, config=config)
        for first, fold, winner, some in zip(starts, folds, winners, numbers, strict=True)
    ]  # fmt: skip

    # Each pass's winner, and the same delayed until the last pass has one too.
    stages = [
        [winner, *(Winner(index_bits(config)) for _ in winners[number:])] for number, winner in enumerate(winners, 1)
    ]
    delays = [
        winner_delay(clk, now.word, late.word, pass_latency(config)) for one in stages for now, late in pairwise(one)
    ]
    # A reflection that the design does not have meets nothing.
    none, nothing = (Winner(index_bits(config)).tie({}) for _ in range(2))
    end_0, end_1, end_2 = ([one[-1] for one in stages] + [none, nothing])[:3]
    found_0, found_1, found_2 = (bit() for _ in range(3))
    colour_0, colour_1, colour_2 = (unsigned(RGB_BITS) for _ in range(3))
    colour_low = new_facet.slice("colour")[1]
    colour_end = colour_low + RGB_BITS

    @always(clk.posedge)
    def look_up_colours():
        found_0.next = end_0.valid
        found_1.next = end_1.valid
        found_2.next = end_2.valid
        colour_0.next = facet_words[end_0.index][colour_end:colour_low]
        colour_1.next = facet_words[end_1.index][colour_end:colour_low]
        colour_2.next = facet_words[end_2.index][colour_end:colour_low]

    blender = colour_blend(
        clk, found_0=found_0, found_1=found_1, found_2=found_2, colour_0=colour_0, colour_1=colour_1, colour_2=colour_2,
        picture=picture, pixel=pixel, config=config,
    )  # fmt: skip

    # Of a facet, a reflector has the axis and the distance, which are next to each other in both.
    mirror_end, mirror_low = new_facet.slice("axis")[0] + 1, new_facet.slice("distance")[1]
    mirror_slopes = [signed(slope_width) for _ in folds[1:]]
    looked_up = winner_latency(config) + LOOK_UP_LATENCY
    mirror_rays = [
        slope_walker(clk, start_line, step_after(first + looked_up + 1), slope, config)
        for first, slope in zip(starts, mirror_slopes, strict=False)
    ]
    if passes > 1:
        first_winner, no_mirror, only = winners[0], Reflector().tie({}), Reflector()

        @always(clk.posedge)
        def look_up_mirror():
            only.word.next = concat(True, facet_words[first_winner.index][mirror_end:mirror_low])

        first_folder = ray_fold(
            clk, earlier=no_mirror, last=only, column_slope=mirror_slopes[0], row_slope=row_slope, fold=folds[1],
            view_distance=view_distance,
        )  # fmt: skip
    if passes > 2:
        late_winner, second_winner, earlier, last = stages[0][1], winners[1], Reflector(), Reflector()

        @always(clk.posedge)
        def look_up_mirrors():
            earlier.word.next = concat(True, facet_words[late_winner.index][mirror_end:mirror_low])
            last.word.next = concat(True, facet_words[second_winner.index][mirror_end:mirror_low])

        second_folder = ray_fold(
            clk, earlier=earlier, last=last, column_slope=mirror_slopes[1], row_slope=row_slope, fold=folds[2],
            view_distance=view_distance,
        )  # fmt: skip

    return instances()
