# SPDX-License-Identifier: MIT
"""Leaf test of `span_renderer`: scenes that are drawn in time, late and in part, with the times of the model."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from engine_vectors import TINY_SCREEN, check_frames, scene_in_view, scene_inputs, small_config, start_cycle
from vectors import designs

from raycaster.golden.frames import FIRST_DEAL, frame_cycles, runs_of
from raycaster.golden.spans import Row, SpanModel
from raycaster.rtl.span.span_renderer import span_renderer
from raycaster.screens import Screen, Span
from raycaster.verif.expected import sorted_rect

FAST_SCREEN = Screen(
    columns=8, rows=3, horizon_row=1, doubling=1,
    horizontal=Span(8, 2, 4, 2, active_high=False), vertical=Span(3, 1, 1, 1, active_high=True),
)  # fmt: skip
"""A screen that shows a frame in less time than it takes to draw some scenes."""


def first_runs(rows: Sequence[Row], count: int) -> list[Row]:
    """Return the rows up to this many runs."""
    first = []
    for row in rows:
        first.append(replace(row, runs=row.runs[:count], taken=row.taken[:count]))
        count -= len(first[-1].runs)
        if not count:
            break
    return first


@designs(
    small_config(TINY_SCREEN, engine="span", rectangles=1, reflections=1, pixels=2, colour_bits=4),
    small_config(FAST_SCREEN, engine="span", rectangles=1, reflections=1, scale=1, units=2, list=6),
    small_config(FAST_SCREEN, engine="span", rectangles=1, reflections=1, scale=1, list=6),
)
def test_span_renderer(config, leaf_of, random):
    """A scene with one rectangle, so the memory's answer never changes, or a black one, goes live with take_scene."""
    screen, columns, units = config.screen_geometry, config.screen_geometry.columns, config.units
    leaf = leaf_of(span_renderer, config)
    leaf.stimulus += [{"reset": 1, "picture_run": 0}] * 2
    first = FIRST_DEAL + (config.rectangles if units > 1 else 0)
    black = np.zeros((screen.rows, columns), dtype=int)
    drawn, shown, whole, whole_at, black_now = black, black, True, -1, True
    pictures, strobes, held, seen = [], defaultdict(set), {"reset": 0}, Counter()
    now = start_cycle(screen)
    leaf.stimulus += [held] * (now + 1)
    for number in range(leaf.some(75)):
        strobes[now] |= {"start_screen"}
        if whole_at < now:
            strobes[now] |= {"take_scene"} | ({"frames_shown"} if whole and not black_now else set())
            strobes[now] |= set() if whole else {"frames_again"}
            shown = drawn if whole else shown
            camera, table, background, reflections, drawn = scene_in_view(random, config, number % 3)
            black_now = seen["take_scene"] % 5 == 4
            held = scene_inputs(camera, table, background, reflections) | {"picture_run": int(not black_now)}
            if table.axes[0] >= 0:
                held |= sorted_rect(table, 0, "rects_rect")
            whole_at = now + 1
            if black_now:
                drawn, whole = black, True
            else:
                rows = [*SpanModel(table, camera, background, columns, reflections).rows(screen)]
                whole = runs_of(rows) <= config.list
                if not whole:
                    rows, seen["abandoned"] = first_runs(rows, config.list + 1), seen["abandoned"] + 1
                whole_at = now + frame_cycles(rows, columns, units, 2 * columns, first) - (not whole)
                strobes[whole_at] = {"frames_drawn", whole_at - now} if whole else {"frames_list_full"}
        else:
            strobes[now] |= {"frames_late", "frames_again"}
        seen.update(strobes[now])
        pictures.append(shown)
        leaf.stimulus += [held] * screen.frame_cycles
        now += screen.frame_cycles
    leaf.stimulus.pop()  # the next StartScreen
    # The first fetch is in the first frame.
    outputs = leaf.check(settled=2 + start_cycle(screen) + screen.frame_cycles)[2:]
    names = [f"progress_{name}" for name in ("start_screen", "take_scene")]
    names += [f"progress_frames_{name}" for name in ("shown", "again", "late", "list_full", "drawn")]
    for cycle, output in enumerate(outputs):
        found = {name.removeprefix("progress_") for name in names if output[name]}
        if output["progress_frames_drawn"]:
            found.add(output["progress_frames_time"])
        assert found == strobes.get(cycle, set()), f"cycle {cycle}"
    check_frames(outputs, config, pictures)
    assert min(seen["frames_shown"], seen["take_scene"] - seen["frames_shown"]) > 1
    assert seen["frames_late"] or units > 1 or config.pixels > 1
    assert seen["abandoned"] > 1 or config.pixels > 1
    assert len(np.unique(np.concatenate(pictures))) > 5
