# SPDX-License-Identifier: MIT
"""Designs, stimuli and monitors for leaf tests of blocks that trace whole rays."""

from dataclasses import replace
from itertools import pairwise
from typing import Any
from unittest import mock

import numpy as np
from hard_scenes import (
    cornered,
    edged,
    facing,
    pixel_ports,
    pixel_word,
    rectangles_in_view,
    rivalled,
    traced_scene,
    tracer,
)
from vectors import AXES, Bench, basis_inputs, by_axis, colour_word

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.design.decide import configure
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.rtl.engines import ENGINES
from raycaster.scene import UNTURNED
from raycaster.screens import LIST_SCREENS, SCREENS, Screen, Span
from raycaster.verif.expected import TraceCycle, sorted_rect, trace_cycles
from raycaster.verif.random_world import random_basis

SMALL_SCREEN = Screen(
    columns=16, rows=4, horizon_row=3, doubling=2,
    horizontal=Span(32, 8, 24, 20, active_high=False), vertical=Span(8, 1, 2, 2, active_high=True),
)  # fmt: skip
"""A screen so small that MyHDL's simulator shows a whole frame in seconds."""


def small_config(screen: Screen = SMALL_SCREEN, **options) -> Configuration:
    """Make a configuration for a screen that has no name."""
    buffered = not ENGINES[options.get("engine", "seed")].facts.whole_frames
    screen = screen if buffered else replace(screen, clocks_per_pixel=1)
    with mock.patch.dict(SCREENS if buffered else LIST_SCREENS, {("tiny", screen.rows): screen}):
        config = configure(screen="tiny", rows=screen.rows, **options)
        shown = screen.scaled(config.scale)
        # The first access looks the screen up and caches it.
        assert config.screen_geometry == (shown if config.pixels == 1 else shown.paired())
    return config


def usable_of(table: Rectangles) -> list[int]:
    """Return the indices of the rectangles that are enabled and have a plane."""
    return [int(index) for index in np.flatnonzero(table.visible)]


def usable_mask(table: Rectangles) -> int:
    """Return the same as a mask."""
    return sum(1 << index for index in usable_of(table))


def place_of(config: Configuration, row: int, column: int) -> dict[str, int]:
    """Return the place of a pixel as a unit's inputs."""
    offset, base = divmod(column, config.units)
    return {"place_row": row, "place_column_offset": offset, "column_base": base}


def scene_inputs(camera, table: Rectangles, background, reflections: int) -> dict[str, int]:
    """Return a scene without its rectangles, as the inputs of a renderer or of its caster."""
    picture = {"picture_background": colour_word(background), "picture_reflections": reflections}
    return picture | {"rects_usable": usable_mask(table)} | by_axis("camera_", camera)


def fate_of(config: Configuration, golden, table: Rectangles) -> dict[str, Any]:
    """Return a traced group's fate as the control gets it: the keyword arguments of `trace_cycles`."""
    if not (config.culling or config.materials):
        return {}
    behind = {
        (number, index)
        for number, bounce in enumerate(golden.bounces)
        for index in range(len(bounce.numerators))
        if not np.any(bounce.alive & (bounce.numerators[index] * bounce.denominators[index] > 0))
    }
    winners = np.array(golden.winners)
    ended = np.logical_or.accumulate((winners < 0) | (table.mirrors[winners] == 0))
    return {"behind": behind, "lost": next(iter(np.flatnonzero(ended.all(axis=1))), None)}


def rects_shown(random: np.random.Generator, config: Configuration, cycle: TraceCycle, table: Rectangles) -> dict:
    """Return the rectangles that the control and the memory show all units in a cycle, any ones if don't care."""
    inputs, usable = {}, usable_of(table)
    for prefix, index in (("rect", cycle.current), ("offered", cycle.offered)) if usable else ():
        inputs |= sorted_rect(table, int(random.choice(usable)) if index is None else index, prefix, config)
    return inputs


def unrelated_inputs(random: np.random.Generator, config: Configuration) -> dict[str, int]:
    """Return random values for the inputs that a unit reads in a single step; the place, if it need not be stable."""
    inputs = {"rect_axis": int(random.integers(3)), "rect_position": int(random.integers(WORLD_SIZE))}
    if not config.turn:
        inputs["place_row"] = int(random.integers(config.screen_geometry.rows))
        inputs["place_column_offset"] = int(random.integers(config.groups))
    return inputs


def check_ray_unit(leaf: Bench, config: Configuration, random: np.random.Generator, rays: int = 24) -> None:
    """Step rays through a unit as its control does; compare MyHDL and Verilog with the golden model.

    Many of their last hits are close decisions: at edges, next to rivals, in corners, at the world's end.
    """
    screen, basis = config.screen_geometry, UNTURNED
    pixels, rays, alive = [], leaf.some(rays), set()
    # Numbers of surfaces that a ray hits; each must occur, from none to the most.
    fates, every_fate = set(), set(range(config.most_reflections + 2))
    while len(pixels) < rays or fates != every_fate:
        row, column = (
            int(random.choice([0, 1, middle, count - 1, random.integers(count)]))
            for middle, count in ((screen.horizon_row, screen.rows), (screen.centre_column, screen.columns))
        )
        hard = random.choice(["none", "rivalled", "cornered", "facing"], p=[0.3, 0.3, 0.3, 0.1])
        if hard == "facing":
            # A ray nearly along x stays in the world between the facing walls.
            row = int(np.clip(screen.horizon_row + random.integers(-20, 21), 0, screen.rows - 1))
            column = int(np.clip(screen.centre_column + random.integers(-20, 21), 0, screen.columns - 1))
        basis = random_basis(random) if config.turn else UNTURNED
        slope = primary_slopes(screen, basis)[row, column]
        camera, table, background, reflections, golden = traced_scene(random, config, slope[None])
        if hard == "rivalled":
            table = rivalled(random, table, int(golden.winners[0][0]), camera, slope)
        elif hard != "none":
            table = {"cornered": cornered, "facing": facing}[hard](random, table, camera, slope)
        golden = tracer(config)(table, camera, background, slope[None], reflections)
        fate = sum(int(winner[0]) >= 0 for winner in golden.winners)
        if len(pixels) >= rays and fate in fates:
            continue
        fates.add(fate)
        held = scene_inputs(camera, table, background, reflections) | place_of(config, row, column)
        held |= basis_inputs(basis)
        cycles = trace_cycles(config, usable_of(table), reflections, **fate_of(config, golden, table))
        # The place is valid before the ray is loaded.
        leaf.case(held | dict.fromkeys(cycles[0].steps, 0))
        for cycle in cycles:
            inputs = {**held, **cycle.steps, **rects_shown(random, config, cycle, table)}
            if not cycle.steps["steps_screen_to_ray"] and not cycle.steps["steps_find_intersection"]:
                inputs |= unrelated_inputs(random, config)
            wanted = {"fate_towards": cycle.towards, "fate_alive": cycle.alive}
            leaf.case(inputs, {name: value for name, value in wanted.items() if name in leaf.seen})
            alive.add(cycle.alive)
        pixels.append(leaf.cycle)
        # After done, the pixel stays valid whatever the inputs.
        leaf.case(dict.fromkeys(inputs, 0) | {"picture_background": held["picture_background"]})
        leaf.expect(pixel_ports(config, golden.colours[0]))
    assert "fate_alive" not in leaf.seen or alive == {None, 0, 1}
    leaf.check(settled=pixels[0], spare=True)


def monitored(outputs: list[dict[str, int]], config: Configuration) -> list[np.ndarray]:
    """Return the frames that a monitor sees, as rows of pixel words, sampled where its clock has risen.

    With two pixels per clock, the left one is in the low half of each colour. With one clock per pixel, the monitor
    samples in every recorded cycle.
    """
    every_cycle = config.screen_geometry.clocks_per_pixel == 1
    horizontal, vertical = config.screen_geometry.horizontal, config.screen_geometry.vertical
    words, shift = [], config.colour_bits
    for before, output in pairwise(outputs):
        if output["vga_clk"] and (every_cycle or not before["vga_clk"]) and output["vga_blank_n"]:
            for low in range(0, shift * config.pixels, shift):
                red, green, blue = (output[f"vga_{channel}"] >> low & (1 << shift) - 1 for channel in "rgb")
                words.append((red << shift | green) << shift | blue)
    size = horizontal.visible * vertical.visible
    return [
        np.array(words[start : start + size]).reshape(vertical.visible, horizontal.visible)
        for start in range(0, len(words) - size + 1, size)
    ]


def check_frames(outputs: list[dict[str, int]], config: Configuration, pictures: list[np.ndarray]) -> None:
    """Check that the monitor sees these pictures, rows of pixel words of the engine, one after the other."""
    frames = monitored(outputs, config)
    assert len(frames) == len(pictures)
    doubling = config.screen_geometry.doubling
    for number, (frame, words) in enumerate(zip(frames, pictures, strict=True)):
        assert np.array_equal(frame, words.repeat(doubling, axis=0).repeat(doubling, axis=1)), f"frame {number}"


def golden_words(config: Configuration, colours: np.ndarray) -> np.ndarray:
    """Return a picture of the golden model as rows of pixel words."""
    screen = config.screen_geometry
    words = [pixel_word(config, colour) for colour in colours.reshape(-1, 3)]
    return np.array(words).reshape(screen.rows, screen.columns)


def start_cycle(screen: Screen) -> int:
    """Cycles from the end of reset to the first StartScreen."""
    return (screen.vertical.blank - screen.doubling) * screen.line_cycles


TINY_SCREEN = Screen(
    columns=8, rows=2, horizon_row=1, doubling=2,
    horizontal=Span(16, 8, 24, 20, active_high=False), vertical=Span(4, 1, 2, 2, active_high=True),
)  # fmt: skip
"""A screen that shows many frames in a short time."""


def scene_in_view(random: np.random.Generator, config: Configuration, axis: int) -> tuple:
    """Return a camera, a table, a background, a number of reflections, and the picture.

    Most pictures show several colours and a plane on this axis, and change if the camera moves one unit along it.
    """
    slopes = primary_slopes(config.screen_geometry).reshape(-1, 3)
    anything = random.random() < 0.2
    for _ in range(2000):
        camera = random.integers(WORLD_SIZE, size=3) // [random.choice([1, 2]), 1, 1]
        table = rectangles_in_view(random, camera, slopes, config.rectangles, None if anything else axis)
        enabled = random.random(config.rectangles) < 0.7
        enabled[0] |= not anything
        table = Rectangles(table.corners, table.colours, enabled)
        background = random.integers(256, size=3)
        reflections = int(random.integers(config.most_reflections + 1))
        trace = tracer(config, background=background, reflections=reflections)
        ray = slopes[random.integers(len(slopes))][None]
        table = edged(random, config, trace(table, eye=camera, slopes=ray), table)
        words = golden_words(config, trace(table, eye=camera, slopes=slopes).colours)
        beside = camera ^ (np.arange(3) == axis)
        moved = golden_words(config, trace(table, eye=beside, slopes=slopes).colours)
        if anything or (
            len(np.unique(words)) > 1 and axis in table.axes[table.visible] and not np.array_equal(moved, words)
        ):
            return camera, table, background, reflections, words
    raise AssertionError(f"no scene depends on the camera's place along {AXES[axis]}")
