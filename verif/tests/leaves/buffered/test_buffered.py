# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that draw rows of rays into a line buffer."""

from itertools import pairwise

import numpy as np
from engine_vectors import (
    TINY_SCREEN,
    check_frames,
    fate_of,
    golden_words,
    scene_in_view,
    scene_inputs,
    small_config,
    start_cycle,
    usable_of,
)
from fates import may_hit_mask
from hard_scenes import pixel_word, traced_scene, tracer
from vectors import any_config, basis_inputs, check_fetches, designs

from raycaster.configuration import Configuration
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.rtl.buffered.ray_caster import ray_caster
from raycaster.rtl.buffered.ray_caster_renderer import ray_caster_renderer
from raycaster.rtl.common.widths import pixel_bits
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY
from raycaster.rtl.engines import buffered_engine_of
from raycaster.scene import UNTURNED
from raycaster.screens import Screen, Span
from raycaster.verif.expected import TraceCycle, rect_cycles, sorted_rect, trace_cycles
from raycaster.verif.random_world import random_basis


def place_after(config: Configuration, place: tuple[int, int]) -> tuple[int, int]:
    """Return the row and group that follow in a frame."""
    row, offset = place
    return (row, offset + 1) if offset < config.groups - 1 else (row + 1, 0)


def places_before(random: np.random.Generator, config: Configuration, place: tuple[int, int]) -> list[tuple[int, int]]:
    """Pick groups to render before this one: the frame's first, sometimes its second, mostly the group before this.

    The rows in between are abandoned.
    """
    row, offset = place
    before = (row, offset - 1) if offset else (row - 1, config.groups - 1)
    second = [(0, 1)] * int(random.random() < 0.2)
    return [(0, 0), *second, *([before] if random.random() < 0.8 else [])]


def remembered(config: Configuration, cycles: list[TraceCycle], usable: list[int]) -> list[int]:
    """Return the rectangle that the memory shows in each cycle of a trace, in the cycle of done, and in the next.

    The control fetches one for each test and each pass, even if nobody waits for it; if none is left, the lowest.
    """
    queue = [*usable, *[0] * len(cycles)]
    held, blends, indices = 0, 0, []
    for before, cycle in pairwise([None, *cycles]):
        if cycle.current is not None:
            held = cycle.current
        elif blends:
            held = queue[blends - 1]
        elif before is not None and (before.current is not None or before.steps["steps_screen_to_ray"]):
            held = 0
        blends = blends + 1 if cycle.steps["steps_add_colour"] else 0
        indices.append(held)
    # A test of one cycle is over in the cycle of done.
    return [*indices, queue[blends - 1], queue[blends - (rect_cycles(config) > 1)]]


@designs(
    any_config(units=1, rectangles=4, reflections=1, divider_bits=3),
    any_config(units=2, rectangles=8, reflections=2, fraction_bits=4, rounding="nearest", divider_bits=3),
    any_config(units=5, rectangles=5, reflections=1, fraction_bits=1, divider_bits=2, colour_bits=4),
    any_config(engine="exact", units=1, rectangles=4, reflections=2),
    any_config(engine="exact", units=2, rectangles=8, reflections=1),
    any_config(engine="exact", units=5, rectangles=7, reflections=0, colour_bits=4),
    any_config(units=4, rectangles=6, reflections=2, divider_bits=1, culling=False),
    any_config(engine="exact", units=4, rectangles=6, reflections=2, culling=True),
    any_config(units=2, rectangles=6, reflections=2, divider_bits=3, materials=True, patterns=True),
    any_config(units=4, rectangles=5, reflections=2, divider_bits=3, materials=True, culling=False),
    any_config(engine="exact", units=2, rectangles=6, reflections=2, materials=True),
    any_config(engine="exact", units=4, rectangles=6, reflections=1, turn=True, culling=True),
    slow=[
        "exact-vga240-u1-r4-m2", "exact-vga240-u4-r6-m2", "exact-vga240-u5", "seed-vga240-u1-",
        "seed-vga240-u4-r5-m2-f0t-d3-c8-k0", "seed-vga240-u5",
    ],
)  # fmt: skip
def test_ray_caster(config, leaf_of, random):
    """Pixels of both engines, and the cycle of done.

    With culling, a group follows others of its frame, during which its rectangles were tested or not.
    """
    leaf = leaf_of(ray_caster, config, pixels=config.units * pixel_bits(config))
    predicts = config.culling and not config.turn
    results, shown, culled = [], {}, 0
    for _ in range((160 if config.engine == "exact" else 80) if config.units == 1 else 12):
        basis = random_basis(random) if config.turn else UNTURNED
        groups = primary_slopes(config.screen_geometry, basis)
        groups = groups.reshape(len(groups), config.groups, config.units, 3)
        last = int(random.integers(1, len(groups))), int(random.integers(config.groups))
        camera, table, background, reflections, _ = traced_scene(random, config, groups[last])
        trace = tracer(config, eye=camera, background=background, reflections=reflections)
        usable = usable_of(table)
        scene = scene_inputs(camera, table, background, reflections) | (basis_inputs(basis) if config.turn else {})
        rects = {index: sorted_rect(table, index, "rects_rect", config) for index in usable}
        following, at_hand = None, 0
        places = [*places_before(random, config, last), last] if config.culling else [last]
        for place in places:
            golden = trace(table, slopes=groups[place])
            fate = fate_of(config, golden, table)
            if predicts and place == following:
                mask = may_hit_mask(config, table, camera, *place)
                fate["may_hit"] = [index for index in usable if mask >> index & 1]
                culled += len(usable) - len(fate["may_hit"])
            held = {**scene, "place_row": place[0], "place_column_offset": place[1]}
            if place == places[0]:
                leaf.case({**held, "reset_ray_caster": 1, "enable": 1})
            leaf.case({**held, **rects.get(at_hand, {}), "reset_ray_caster": 1, "enable": 1})
            leaf.stimulus += [{**held, "reset_ray_caster": 0, "enable": 0}] * int(random.integers(3))
            leaf.case({**held, "reset_ray_caster": 0, "enable": 1})
            cycles = trace_cycles(config, usable, reflections, **fate)
            *indices, at_hand = remembered(config, cycles, usable)
            shown |= {leaf.cycle + number: index for number, index in enumerate(indices) if number}
            for index in indices:
                rect = rects.get(index, {})
                leaf.case({**held, **rect, "reset_ray_caster": 0, "enable": int(random.integers(2))})
            # Within a frame, the cycle of done is the first of a reset.
            leaf.stimulus[-1]["reset_ray_caster"] = int(place != last)
            colours = [pixel_word(config, colour) for colour in golden.colours]
            results.append((leaf.cycle - 1, colours))
            # The first group copies the rectangles; the others test them if they take long enough.
            tests = place != (0, 0) and len(cycles) >= config.rectangles + SETUP_LATENCY
            following = place_after(config, place) if tests else None
        leaf.case({})
        results.append((leaf.cycle - 1, results[-1][1]))
    for cycle, colours in results:
        pixels = sum(colour << pixel_bits(config) * unit for unit, colour in enumerate(colours))
        leaf.expected.setdefault(cycle - 1, {"done": 0})
        leaf.expected[cycle] = {"done": 1, "pixels": pixels}
    outputs = leaf.check(settled=results[0][0])
    check_fetches(outputs, shown, "rects_")
    assert bool(culled) == predicts, "rectangles must be culled exactly if the design predicts"


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
