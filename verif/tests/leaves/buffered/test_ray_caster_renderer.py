# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_caster_renderer`."""

from itertools import pairwise

import numpy as np
from engine_vectors import (
    TINY_SCREEN,
    check_frames,
    golden_words,
    scene_in_view,
    scene_inputs,
    small_config,
    start_cycle,
)
from hard_scenes import pixel_word
from vectors import designs

from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.rtl.buffered.ray_caster_renderer import ray_caster_renderer
from raycaster.rtl.engines import buffered_engine_of
from raycaster.screens import Screen, Span
from raycaster.verif.expected import sorted_rect, trace_cycles

COARSE = Screen(
    columns=8, rows=2, horizon_row=1, doubling=4, clocks_per_pixel=1, distance=50,
    horizontal=Span(32, 8, 48, 40, active_high=False), vertical=Span(8, 1, 2, 2, active_high=True),
)  # fmt: skip
"""A screen with one clock per pixel and half the slope ahead."""


@designs(
    small_config(units=4, rectangles=1, reflections=1, colour_bits=8, culling=False),
    small_config(units=2, rectangles=1, reflections=0, fraction_bits=4, rounding="nearest", culling=False),
    small_config(units=4, rectangles=1, reflections=2, divider_bits=3, colour_bits=2, culling=False),
    small_config(units=4, rectangles=1, reflections=2, colour_bits=4),
    small_config(COARSE, units=4, rectangles=1, reflections=1, culling=False),
    # 16 groups of 27 cycles each; a row of 336 cycles has time for twelve.
    small_config(
        units=1, rectangles=1, reflections=0, fraction_bits=8, divider_bits=1, allow_underrun=True, culling=False
    ),
    slow=["seed-tiny4-u4-r1-m2"],
)
def test_ray_caster_renderer(config, leaf_of, random):
    """One rectangle, so the memory's answer never changes; the first frame shows none, the third is black."""
    screen = config.screen_geometry
    camera = np.array([100, 200, 100])
    # At twice the distance of the viewing rectangle, a column is two units wide and a row two units high.
    corners, colours = np.array([[(301, 511, 104), (301, 192, 100)]]), random.integers(1, 256, size=(1, 3))
    table = Rectangles(corners, colours.astype(np.uint8), np.ones(1, dtype=bool))
    background = random.integers(1, 256, size=3)
    scene = scene_inputs(camera, table, background, config.most_reflections) | sorted_rect(table, 0, "rects_rect")
    del scene["rects_usable"]
    start, frame = start_cycle(screen), screen.frame_cycles
    # From the cycle after each StartScreen on, the next scene.
    leaf = leaf_of(ray_caster_renderer, config)
    leaf.stimulus += [{**scene, "reset": 1}] * 2
    leaf.stimulus += [{"reset": 0, "picture_run": 1, "rects_usable": 0}] * (start + 1 + frame)
    leaf.stimulus += [{"rects_usable": 1}] * frame + [{"picture_run": 0}] * (frame // 2)
    # The control's fetches are known from the first group on.
    outputs = leaf.check(settled=2 + start + 6)[2:]

    slopes = primary_slopes(screen).reshape(-1, 3)
    colours = model_of(config).trace(table, camera, background, slopes, config.most_reflections).colours
    golden = golden_words(config, colours)
    assert len(set(golden.flat)) > 1, "the rectangle must have an edge in view"
    empty = np.full_like(golden, pixel_word(config, background))
    group = len(trace_cycles(config, [0], config.most_reflections)) + 3
    assert group == buffered_engine_of(config).group_cycles(config)
    groups_in_time = min(config.groups, (screen.row_cycles - 1) // group)
    shown = golden.copy()
    # Columns that were not written in time keep their half's old content, from the empty scene.
    shown[:, groups_in_time * config.units :] = empty[:, groups_in_time * config.units :]
    check_frames(outputs, config, [empty, shown])
    assert (groups_in_time < config.groups) == config.allow_underrun

    assert not any(output[f"vga_{channel}"] for output in outputs[start + 2 * frame + 1 :] for channel in "rgb")

    strobes = [cycle for cycle, output in enumerate(outputs) if output["progress_start_screen"]]
    assert strobes == [start, start + frame, start + 2 * frame]
    late = [cycle for cycle, output in enumerate(outputs) if output["progress_underrun"]]
    rows = [start + frame + row * screen.row_cycles for row in range(1, screen.rows + 1)]
    assert late == (rows if config.allow_underrun else [])
    in_second = outputs[start + frame + 1 : start + 2 * frame]
    busy = sum(output["progress_busy"] for output in in_second)
    if config.culling:
        # The first two groups are not culled, as nothing is known yet.
        assert 2 * group < busy < screen.rows * config.groups * group / 2
        return
    if not config.allow_underrun:
        row_cycles = max(output["progress_row_cycles"] for output in in_second if output["progress_busy"])
        assert row_cycles == config.groups * group
        assert busy == screen.rows * config.groups * group
        times = [output["progress_group_cycles"] for output in in_second]
        finished = [before for before, after in pairwise(times) if after < before]
        assert finished == [group] * screen.rows * config.groups
    assert max(output["progress_group_cycles"] for output in in_second) == group


@designs(
    small_config(TINY_SCREEN, units=2, rectangles=1, reflections=1, divider_bits=1),
    slow=["seed"],
)
def test_ray_caster_renderer_scenes(config, leaf_of, random):
    """One scene per frame, with one rectangle anywhere, and once disabled."""
    screen = config.screen_geometry
    leaf = leaf_of(ray_caster_renderer, config)
    count = leaf.some(30)
    scenes = [scene_in_view(random, config, number % 3) for number in range(count)]
    camera, table, background, reflections, words = next(scene for scene in scenes if len(np.unique(scene[-1])) > 1)
    disabled = Rectangles(table.corners, table.colours, np.zeros(1, dtype=bool))
    empty = golden_words(config, np.broadcast_to(background, (words.size, 3)))
    scenes.insert(0, (camera, disabled, background, reflections, empty))
    leaf.stimulus += [{"reset": 1, "picture_run": 1}] * 2
    start = start_cycle(screen)
    for number, (camera, table, background, reflections, _) in enumerate(scenes):
        scene = scene_inputs(camera, table, background, reflections) | {"reset": 0}
        if table.axes[0] >= 0:
            scene |= sorted_rect(table, 0, "rects_rect")
        # From the cycle after each StartScreen on, the next scene.
        leaf.stimulus += [scene] * (screen.frame_cycles if number else start + 1 + screen.frame_cycles)
    leaf.stimulus += [{"picture_run": 0}] * screen.frame_cycles
    shown = leaf.cycle - 2
    leaf.stimulus += [{"reset": 1}] * 2
    outputs = leaf.check(settled=2 + start + 6)[2:]
    assert not any(output["progress_busy"] for output in outputs[shown:])
    # The last frame is black.
    check_frames(outputs[:shown], config, [*(scene[-1] for scene in scenes), 0 * empty])
