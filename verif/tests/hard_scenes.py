# SPDX-License-Identifier: MIT
"""Scenes for leaf tests in which one ray tells a lot: it meets mirrors to its end, and edges where it does."""

from functools import partial

import numpy as np

from raycaster.configuration import CHANNEL_BITS, WORLD_SIZE, Configuration
from raycaster.golden import exact, seed_engine
from raycaster.golden.random_world import random_camera, random_rectangles
from raycaster.golden.world import OTHER_AXES, Rectangles


def rectangles_in_view(random: np.random.Generator, camera: np.ndarray, slopes: np.ndarray, count: int) -> Rectangles:
    """Small rectangles where some ray passes, so that rays see this one or that one."""
    targets = camera + slopes[random.integers(len(slopes), size=count)] * random.uniform(0, 3.5, (count, 1))
    size = random.choice([0, 3, 40, 400], (count, 2, 3)) * np.array([-1, 1]).reshape(1, 2, 1)
    corners = np.clip(targets[:, None, :] + size, 0, WORLD_SIZE - 1).astype(np.int64)
    flat = random.integers(3, size=count)
    corners[np.arange(count), 1, flat] = corners[np.arange(count), 0, flat]
    return Rectangles(corners, random.integers(256, size=(count, 3)).astype(np.uint8), random.random(count) < 0.9)


def scene_of(random: np.random.Generator, slopes: np.ndarray, count: int) -> tuple[np.ndarray, Rectangles]:
    """A camera and a table: some in view, some from anywhere."""
    if random.random() < 0.4:
        table = random_rectangles(random, count, closed=None if count >= 7 else False)
        return random_camera(random, table), table
    camera = random.integers(WORLD_SIZE, size=3) // [2, 1, 1]
    return camera, rectangles_in_view(random, camera, slopes, count)


def edged(random: np.random.Generator, config: Configuration, golden, table: Rectangles) -> Rectangles:
    """The table with the rectangle that the first ray hits last made hard to tell: one of its edges moved to the hit
    point or next to it, or a copy of it a few units before or behind."""
    hits = [(bounce, int(winner[0])) for bounce, winner in zip(golden.bounces, golden.winners, strict=True)]
    hits = [(bounce, winner) for bounce, winner in hits if winner >= 0]
    if not hits:
        return table
    bounce, winner = hits[-1]
    corners = table.corners.copy()
    flat, other = int(table.axes[winner]), int(random.integers(len(table)))
    if random.random() < 0.4 and other != winner:
        corners[other] = corners[winner]
        corners[other, :, flat] = np.clip(corners[winner, 0, flat] + random.integers(-4, 5), 0, WORLD_SIZE - 1)
    axis = int(random.choice(OTHER_AXES[flat]))
    point = int(bounce.points[winner, 0][axis])
    whole = point // int(bounce.denominators[winner, 0]) if config.engine == "exact" else point >> config.fraction_bits
    place = whole + int(random.integers(-1, 2))
    corners[winner, int(random.integers(2)), axis] = np.clip(place, 0, WORLD_SIZE - 1)
    return Rectangles(corners, table.colours, table.enabled)


def traced_scene(random: np.random.Generator, config: Configuration, slopes: np.ndarray) -> tuple:
    """Camera, table, background and reflections, and golden's trace of them.

    In most, the first ray meets mirrors to its end, and the last of them near an edge: what comes late tells most.
    """
    rich = random.random() < 0.7
    for _ in range(300):
        camera, table = scene_of(random, slopes, config.rectangles)
        background = random.integers(256, size=3)
        reflections = config.reflections if rich else int(random.integers(config.reflections + 1))
        given = {"camera": camera, "background": background, "slopes": slopes, "reflections": reflections, "keep": True}
        if config.engine == "exact":
            trace = partial(exact.trace, **given)
        else:
            trace = partial(seed_engine.trace, **given, fraction_bits=config.fraction_bits, rounding=config.rounding)
        golden = trace(table)
        if rich and all(winner[0] >= 0 for winner in golden.winners):
            table = edged(random, config, golden, table)
            golden = trace(table)
            break
        if not rich:
            break
    return camera, table, background, reflections, golden


def pixel_word(config: Configuration, colour) -> int:
    """A pixel of 8 bits a channel as the design puts it out."""
    word = 0
    for channel in colour:
        word = word << config.colour_bits | int(channel) >> (CHANNEL_BITS - config.colour_bits)
    return word
