# SPDX-License-Identifier: MIT
"""Leaf tests of `span_unit` and `span_control`: whole tiny frames, each row in as many cycles as the model says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise, zip_longest
from math import log1p

import numpy as np
import pytest
from conftest import plant
from span_vectors import Frame, any_frame, frame_bench, frame_inputs, scene_frame, span_config
from vectors import config_id

from raycaster.configuration import FEATURES, MOST_RECTANGLES, Configuration
from raycaster.golden.picture import describe_difference
from raycaster.golden.spans import Row, picture_of
from raycaster.golden.world import Rectangles
from raycaster.scene import load_scene, packaged_scenes

TINY = {"screen": "tiny", "rectangles": 12}

DESIGNS = [
    span_config(**TINY, reflections=0),
    span_config(**TINY, reflections=1),
    span_config(**TINY | {"rectangles": 1}, reflections=2, materials=True),
    span_config(**TINY | {"rectangles": 32}, reflections=3, materials=True),
    span_config(**TINY, reflections=2, turn=True),
    span_config(**TINY, reflections=2, patterns=True),
    span_config(**TINY, reflections=0, light=True),
    span_config(**TINY, reflections=1, turn=True, light=True),
    span_config(**TINY, reflections=4, turn=True, materials=True, patterns=True, light=True),
]

ROWS = 2
"""Rows of each frame that are drawn, if slow tests are left out or rows are long."""

SCENES = {name: load_scene(path) for name, path in sorted(packaged_scenes().items())}


def busy_frames(
    random: np.random.Generator, config: Configuration, number: int = 1, rectangles: int | None = None
) -> list[Frame]:
    """Return the frames whose first rows take many steps of each kind; most random frames show little."""

    def work(frame: Frame) -> float:
        screen = config.screen_geometry
        return sum(map(log1p, next(frame.rows(screen)).steps.values()))

    return sorted((any_frame(random, config, rectangles) for _ in range(12)), key=work)[-number:]


def unit_bench(leaf_of, config: Configuration):
    """Make the bench of a unit, with what its model must know of the design."""
    leaf = leaf_of(frame_bench, config)
    leaf.screen, leaf.has = config.screen_geometry, {"patterns": config.patterns, "lights": config.light}
    return leaf


def drawn(
    leaf, frames: Sequence[Frame], ready=lambda: 1, most: int | None = None, cuts: Sequence[tuple[Frame, int]] = ()
) -> Iterator[tuple[list[Row], list[Row]]]:
    """Simulate frames, in Verilog with unknown values at power-up; yield the rows of each, and those of the model.

    Args:
        leaf: the bench.
        frames: frames to draw.
        ready: returns whether a run is taken in the next cycle.
        most: number of rows to draw, all by default.
        cuts: for each frame, one that is begun before it, and the cycles after which a reset ends that one.
    """
    screen = leaf.screen
    count = most or screen.rows
    expected = [list(islice(frame.rows(screen, **leaf.has), count)) for frame in frames]
    begins, stimulus = [], [{"reset": 1, "first_row": 0, "store": 0, "run_ready": 1}] * 3
    for frame, rows, cut in zip_longest(frames, expected, cuts):
        if cut is not None:
            begun, cycles = cut
            stimulus += [*frame_inputs(begun), *[{}] * cycles, {"reset": 1}]
        stimulus += frame_inputs(frame)
        # The first row begins two cycles after first_row.
        begins.append(len(stimulus))
        patience = 4 if ready() != 1 or ready() != 1 else 1
        stimulus += [{"run_ready": ready()} for _ in range(patience * sum(row.cycles for row in rows) + 8)]
        stimulus += [{"reset": 1}]
    given = [{name: int(value) for name, value in cycle.items() if name in leaf.given} for cycle in stimulus]
    outputs = leaf.run_verilog(given, power_up=False)
    held = {}
    for cycle, inputs in enumerate(given):
        held |= inputs
        outputs[cycle]["ready"] = held["run_ready"]
    for begin, wanted in zip(begins, expected, strict=True):
        rows, row, start = [], Row(), begin
        for cycle in range(begin, len(outputs)):
            seen = outputs[cycle]
            assert None not in (seen["done"], seen["run_valid"]), f"cycle {cycle}: unknown"
            if seen["done"] and len(rows) < count:
                row.cycles, start = cycle - start, cycle
                rows.append(row)
                row = Row()
            if seen["run_valid"] and seen["ready"] and len(rows) < count:
                assert None not in (seen["run_end"], seen["run_colour"]), f"cycle {cycle}: unknown"
                row.runs.append((seen["run_end"], tuple(seen["run_colour"].to_bytes(3))))
                row.taken.append(cycle - start)
        yield rows, wanted


def check_frames(leaf, frames: Sequence[Frame], most: int | None = None) -> None:
    """Compare frames, or some of their rows, with the picture of the golden model and with the span model."""
    screen = leaf.screen
    for frame, (rows, wanted) in zip(frames, drawn(leaf, frames, most=most), strict=True):
        for number, (row, expected) in enumerate(zip(rows, wanted, strict=False)):
            assert (row.runs, row.cycles) == (expected.runs, expected.cycles), f"row {number}"
            assert row.taken == expected.taken, f"row {number}"
            assert all(one < other for one, other in pairwise([0, *(end for end, _ in row.runs)]))
            assert all(one != other for (_, one), (_, other) in pairwise(row.runs))
        assert len(rows) == len(wanted)
        picture = frame.picture(replace(screen, rows=len(rows)))
        assert not describe_difference(picture_of(rows, screen.columns), picture)


@pytest.mark.slow_sets("span-tiny48-s1-u1-r32")
@pytest.mark.parametrize("config", DESIGNS, ids=config_id)
def test_span_unit(config, leaf_of, random):
    """Random, cornered and stiff worlds."""
    leaf = unit_bench(leaf_of, config)
    check_frames(leaf, busy_frames(random, config, 3), most=ROWS)
    if not leaf.few:
        check_frames(leaf, [any_frame(random, config) for _ in range(8)])


@pytest.mark.parametrize("reflections", [0, 1])
def test_a_hundred_rectangles(reflections, leaf_of, random):
    """Worlds of 100 rectangles in the largest table, of which some are at its end."""
    config = span_config(screen="tiny", rectangles=MOST_RECTANGLES, reflections=reflections)
    leaf = unit_bench(leaf_of, config)
    frames = busy_frames(random, config, rectangles=100)
    if not leaf.few:
        frames += [any_frame(random, config, 100) for _ in range(6)]
    check_frames(
        leaf, [replace(frame, table=spread(random, frame.table)) for frame in frames], most=ROWS if leaf.few else None
    )


def spread(random: np.random.Generator, table: Rectangles) -> Rectangles:
    """Return a table of `MOST_RECTANGLES` with these rectangles in any places, also the first and the last, among
    disabled ones."""
    parts = (table.corners, table.colours, table.enabled, table.mirrors, table.kinds, table.cells, table.colours_2)
    while True:
        places = random.permutation(MOST_RECTANGLES) % len(table)
        enabled = np.zeros(MOST_RECTANGLES, dtype=bool)
        enabled[np.unique(places, return_index=True)[1]] = True
        corners, colours, seen, *looks = (part[places] for part in parts)
        found = Rectangles(corners, colours, enabled & seen, *looks)
        if found.visible[[0, -1]].all():
            return found


WIDEST = span_config(rows=180, scale=6, rectangles=12, reflections=4, **dict.fromkeys(FEATURES, True))


def test_full_hd(leaf_of, random):
    """The first rows of 1920 columns, with the greatest widths."""
    leaf = unit_bench(leaf_of, WIDEST)
    frames = busy_frames(random, WIDEST)
    if not leaf.few:
        frames += [any_frame(random, WIDEST) for _ in range(30)]
    check_frames(leaf, frames, most=ROWS)


@pytest.mark.parametrize("config", [DESIGNS[-1], WIDEST], ids=config_id)
def test_both_simulators(config, leaf_of, random):
    """In MyHDL nothing overflows, not even where it does not matter, and all is as in Verilog."""
    leaf, stimulus = unit_bench(leaf_of, config), [{"reset": 1}] * 3
    for frame in busy_frames(random, config, 1 if leaf.few else 12):
        stimulus += [*frame_inputs(frame), *[{}] * 900, {"reset": 1}]
    leaf.run_both([{name: int(value) for name, value in one.items() if name in leaf.given} for one in stimulus])


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_packaged_scenes(name, leaf_of):
    scene = SCENES[name]
    looks = {look: True for look in FEATURES if scene.lacks({*FEATURES} - {look})}
    config = span_config(screen="tiny", rectangles=max(12, len(scene.rect)), reflections=scene.reflections, **looks)
    leaf = unit_bench(leaf_of, config)
    check_frames(leaf, [scene_frame(scene)])


def test_a_reset_ends_a_row(leaf_of, random):
    """After a reset in any cycle of a row with all kinds of work, the row of another scene is drawn as ever.

    So is the same row anew, whose first run ends where the one ended that was held.
    """
    config = DESIGNS[-1]
    leaf = unit_bench(leaf_of, config)

    def frames(least: int, most: int, *kinds: str) -> Iterator[tuple[Frame, int]]:
        """Yield frames whose first row takes so many cycles and steps of these kinds, and these cycles."""
        while True:
            frame = any_frame(random, config)
            row = next(frame.rows(leaf.screen, **leaf.has))
            if least <= row.cycles <= most and all(row.steps[kind] for kind in kinds):
                yield frame, row.cycles

    short = [*islice(frames(0, 180), 2), *islice(frames(100, 180, "lit"), 2), *islice(frames(100, 180, "cells"), 2)]
    empty = replace(short[0][0].table, enabled=np.zeros(config.rectangles, dtype=bool))
    after = [*(frame for frame, _ in short), replace(short[0][0], table=empty)]
    busy = [*islice(frames(250, 900, "lit", "cells", "corner tests", "divisions"), 3)]
    every = 15 if leaf.few else 2
    cuts = [(one, cut) for one, cycles in busy for cut in range(int(random.integers(every)), cycles, every)]
    after = [after[number % len(after)] for number in range(len(cuts))]
    again = [(one, cut) for one, cycles in short[2:] for cut in range(int(random.integers(every)), cycles, every)]
    rows = drawn(leaf, [*after, *(one for one, _ in again)], most=1, cuts=[*cuts, *again])
    for (_, cut), (found, wanted) in zip([*cuts, *again], rows, strict=True):
        assert found == [replace(row, steps=Row().steps) for row in wanted], f"after {cut} cycles"


def test_runs_wait(leaf_of, random):
    """A list that is not always ready gets the same runs."""
    config = DESIGNS[1]
    leaf = unit_bench(leaf_of, config)
    [(rows, wanted)] = drawn(leaf, busy_frames(random, config), lambda: int(random.random() < 0.3), most=8)
    assert [row.runs for row in rows] == [row.runs for row in wanted]


FAULTS = [
    ("clipper", "(answer_left < 0) != (answer_right < 0)", "(answer_left <= 0) != (answer_right <= 0)"),
    ("clipper", "border > low", "border < low"),
    ("half_lines", "strict = met", "strict = 0"),
    ("mirror_side", "crosses = chain_mirrored", "crosses = 0"),
    ("division_stage", "next_divisor <= divisor", "next_divisor <= divisor ^ 1"),
    ("sweep", "tested_start <= limit", "tested_start < limit"),
    ("sweep", "follows = outlasts_1 && !shortened", "follows = 0"),
    ("sweep", "later = present_index > rival_index", "later = 0"),
    ("sweep", "take = nearer_heir", "take = 0"),
    ("sweep", "take = answer_left >= 0", "take = 0"),
    ("corner_finder", "at_left = answer_left == 0", "at_left = 0"),
    ("corner_finder", "at_right = answer_right == 0", "at_right = 0"),
    ("fold", "towards = winner_back != back_a", "towards = winner_back"),
    ("first_change", "y = {~kept_value", "y = {-kept_value"),
    ("cell_walker", "up = above_right >= 0", "up = above_right > 0"),
    ("cell_walker", "? (above_left >= 0)", "? 0"),
    ("surface_cells", "wants_v = painting", "wants_v = 0 && painting"),
    ("surface_light", "(light_a > rect_position)", "(light_a >= rect_position)"),
    ("shadow_scan", "tested_stop > next_dark", "tested_stop < next_dark"),
    ("shadow_finder", "offset = light_q - eye_q", "offset = light_q"),
    ("run_joiner", "same = part_colour == colour", "same = 0"),
]
"""A module, and a text of its Verilog with a wrong one."""


@pytest.mark.slow
@pytest.mark.parametrize(("module", "right", "wrong"), FAULTS, ids=lambda text: text.split(" = ")[0])
def test_a_planted_fault_is_noticed(module, right, wrong, leaf_of, random):
    config = DESIGNS[-1]
    leaf = unit_bench(leaf_of, config)
    [path] = [path for path in leaf.verilog if path.stem == module]
    plant(path, right, wrong)
    with pytest.raises(AssertionError):
        for number in range(200):
            frame = any_frame(random, config)
            check_frames(leaf, [in_planes(random, frame) if number % 2 else frame])


def in_planes(random: np.random.Generator, frame: Frame) -> Frame:
    """Return the frame with its light, if any, in the planes of rectangles on each axis."""
    if not frame.light:
        return frame
    place = list(frame.light.position)
    for axis in range(3):
        if len(planes := frame.table.low[frame.table.axes == axis, axis]):
            place[axis] = int(random.choice(planes))
    return replace(frame, light=frame.light.model_copy(update={"position": tuple(place)}))


def test_an_empty_table_shows_the_background(leaf_of, random):
    config = DESIGNS[-1]
    leaf = unit_bench(leaf_of, config)
    frame = any_frame(random, config)
    table = replace(frame.table, enabled=np.zeros(len(frame.table), dtype=bool))
    check_frames(leaf, [replace(frame, table=table)], most=3)
