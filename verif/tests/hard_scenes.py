# SPDX-License-Identifier: MIT
"""Scenes for leaf tests in which a single ray exercises much: it meets mirrors to its end, close to their edges."""

from collections.abc import Callable, Collection
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
from definition import exact_hit

from raycaster.configuration import CHANNEL_BITS, WORLD_SIZE, Configuration
from raycaster.golden.engines import model_of
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.verif.random_world import random_camera, random_looks, random_rectangles
from raycaster.verif.seeds import repeat


def rectangles_in_view(
    random: np.random.Generator, camera: np.ndarray, slopes: np.ndarray, count: int, axis: int | None = None
) -> Rectangles:
    """Return small rectangles on the way of some rays, so that rays see different ones; the first on `axis`."""
    seen = slopes[random.integers(len(slopes), size=count)]
    # Scale the steepest component of a slope to 160 units, whatever the camera's basis is.
    reach = 160 / np.abs(seen).max(axis=1, initial=1, keepdims=True)
    targets = camera + seen * reach * random.uniform(0, 3.5, (count, 1))
    size = random.choice([0, 3, 40, 400], (count, 2, 3)) * np.array([-1, 1]).reshape(1, 2, 1)
    corners = np.clip(targets[:, None, :] + size, 0, WORLD_SIZE - 1).astype(np.int64)
    flat = random.integers(3, size=count)
    if axis is not None:
        flat[0] = axis
    corners[np.arange(count), 1, flat] = corners[np.arange(count), 0, flat]
    return Rectangles(corners, random.integers(256, size=(count, 3)).astype(np.uint8), random.random(count) < 0.9)


def scene_of(random: np.random.Generator, slopes: np.ndarray, count: int) -> tuple[np.ndarray, Rectangles]:
    """Return a camera and a table, with rectangles in view or anywhere."""
    if random.random() < 0.4:
        table = random_rectangles(random, count, closed=None if count >= 7 else False)
        return random_camera(random, table), table
    camera = random.integers(WORLD_SIZE, size=3) // [2, 1, 1]
    return camera, rectangles_in_view(random, camera, slopes, count)


def mirrored_on(random: np.random.Generator, table: Rectangles, camera, slope, mirrors: int) -> Rectangles:
    """Return the table with some rectangles moved into the ray's way, each where the previous one reflects the ray."""
    corners, enabled = table.corners.copy(), table.enabled.copy()
    place, way = np.array(camera, dtype=float), np.array(slope, dtype=float)
    for index in random.permutation(len(table))[:mirrors]:
        moving = np.flatnonzero(way)
        # The way to the end of the world.
        most = min((np.where(way > 0, WORLD_SIZE - 1, 0) - place)[moving] / way[moving])
        axis = int(random.choice(moving))
        plane = int(np.clip(round(place[axis] + way[axis] * most * random.uniform(0.1, 1)), 0, WORLD_SIZE - 1))
        place = place + way * (plane - place[axis]) / way[axis]
        around = random.choice([3, 40, 400], (2, 3)) * np.array([[-1], [1]])
        corners[index] = np.clip(np.rint(place) + around, 0, WORLD_SIZE - 1)
        corners[index, :, axis] = plane
        enabled[index] = True
        way[axis] = -way[axis]
    return replace(table, corners=corners, enabled=enabled)


def with_looks(random: np.random.Generator, config: Configuration, table: Rectangles) -> Rectangles:
    """Return the table with random mirrors and patterns, as far as the design has them."""
    looks = random_looks(random, table)
    if not config.materials:
        looks = replace(looks, mirrors=table.mirrors)
    if not config.patterns:
        looks = replace(looks, kinds=table.kinds)
    return looks


def edged(random: np.random.Generator, config: Configuration, golden, table: Rectangles) -> Rectangles:
    """Return the table with a close decision at the last hit of the first ray: an edge of that rectangle is moved to
    the hit point or next to it, or the rectangle gets a copy a few units in front or behind."""
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
    whole = int(bounce.points[winner, 0][axis]) // int(bounce.scales[winner, 0])
    place = whole + int(random.integers(-1, 2))
    corners[winner, int(random.integers(2)), axis] = np.clip(place, 0, WORLD_SIZE - 1)
    return replace(table, corners=corners)


def rivalled(random: np.random.Generator, table: Rectangles, winner: int, camera, slope) -> Rectangles:
    """Return the table with a rectangle on another axis that the ray meets at or next to its hit of the winner."""
    axis, rival = int(table.axes[winner]), int(random.integers(len(table)))
    across = int(random.choice(OTHER_AXES[axis]))
    if winner in (-1, rival) or slope[across] == 0:
        return table
    t = Fraction(int(table.low[winner, axis] - camera[axis]), int(slope[axis]))
    corners, enabled = table.corners.copy(), table.enabled.copy()
    corners[rival] = [[0] * 3, [WORLD_SIZE - 1] * 3]
    place = round(int(camera[across]) + int(slope[across]) * t) + int(random.integers(-1, 2))
    corners[rival, :, across] = np.clip(place, 0, WORLD_SIZE - 1)
    enabled[rival] = True
    return replace(table, corners=corners, enabled=enabled)


def cornered(random: np.random.Generator, table: Rectangles, camera, slope) -> Rectangles:
    """Return the table with one rectangle, or two on different axes, that the ray meets at whole coordinates: at a
    corner, on an edge, inside, or at the camera, sometimes after another mirror. Unchanged if there is none."""
    camera, slope = np.array(camera), np.array(slope)
    moving = np.flatnonzero(slope)
    if len(moving) < 2 or len(table) < 3:
        return table
    for _ in range(20):
        point = camera + int(random.integers(9)) * slope
        planes = []
        if random.random() < 0.7:
            axis = int(random.choice(moving))
            between = sorted((camera[axis], point[axis]))
            plane = int(random.integers(between[0], between[1] + 1))
            planes.append((axis, plane, camera + slope * (plane - camera[axis]) / slope[axis]))
            point[axis] = 2 * plane - point[axis]
        planes += [(int(axis), int(point[axis]), point) for axis in random.permutation(moving)[: random.integers(1, 3)]]
        places = np.array([place for _, _, place in planes])
        if np.all((places >= 0) & (places < WORLD_SIZE)):
            break
    else:
        return table
    corners, enabled = table.corners.copy(), table.enabled.copy()
    for (axis, plane, place), index in zip(planes, random.permutation(len(table)), strict=False):
        around = random.choice([0, 3, 40, 400], (2, 3)) * np.array([[-1], [1]])
        corners[index] = np.clip(np.rint(place) + around, 0, WORLD_SIZE - 1)
        corners[index, :, axis] = plane
        enabled[index] = True
    return replace(table, corners=corners, enabled=enabled)


def facing(random: np.random.Generator, table: Rectangles, camera, slope) -> Rectangles:
    """Return the table with two rectangles that fill opposite walls of the world, which give the ray the longest
    possible way, and a third one across it."""
    corners, enabled = table.corners.copy(), np.zeros(len(table), bool)
    other, axis = np.argsort(np.abs(slope))[1:]
    t = random.uniform(0, 3 * WORLD_SIZE / abs(slope[axis]))
    across = np.clip(round(camera[other] + slope[other] * t), 0, WORLD_SIZE - 1)
    planes = (axis, 0), (axis, WORLD_SIZE - 1), (other, across)
    for (flat, plane), index in zip(planes, random.permutation(len(table)), strict=False):
        corners[index] = [[0] * 3, [WORLD_SIZE - 1] * 3]
        corners[index, :, flat] = plane
        enabled[index] = True
    return replace(table, corners=corners, enabled=enabled)


def tracer(config: Configuration, **given) -> Callable:
    """Return the golden model's trace for a design's engine, with some of its arguments already given."""
    return partial(model_of(config).trace, keep=True, **given)


def traced_scene(random: np.random.Generator, config: Configuration, slopes: np.ndarray) -> tuple:
    """Return camera, table, background and reflections, and the golden model's trace of them.

    In most of them the first ray meets mirrors to its end, the last one near an edge, as late hits exercise the most.
    """
    rich = random.random() < 0.7
    for _ in range(300):
        camera, table = scene_of(random, slopes, config.rectangles)
        table = with_looks(random, config, table)
        background = random.integers(256, size=3)
        reflections = config.most_reflections if rich else int(random.integers(config.most_reflections + 1))
        if rich and random.random() < 0.7:
            table = mirrored_on(random, table, camera, slopes[0], reflections + 1)
        trace = tracer(config, eye=camera, background=background, slopes=slopes, reflections=reflections)
        golden = trace(table)
        if rich and not all(winner[0] >= 0 for winner in golden.winners):
            continue
        if rich:
            table = edged(random, config, golden, table)
            golden = trace(table)
        return camera, table, background, reflections, golden
    raise AssertionError(f"no scene has a ray that meets mirrors {config.most_reflections} times; {repeat()}")


def pixel_word(config: Configuration, colour) -> int:
    """Return the design's output for a pixel of 8 bits per channel."""
    word = 0
    for channel in colour:
        word = word << config.colour_bits | int(channel) >> (CHANNEL_BITS - config.colour_bits)
    return word


def pixel_ports(config: Configuration, *colours) -> dict[str, int]:
    """Return the port of the pixels of one clock, the left one in the lowest bits of each channel."""
    bits = config.colour_bits
    lanes = [[int(channel) >> CHANNEL_BITS - bits for channel in colour] for colour in colours]
    channels = zip(("red", "green", "blue"), zip(*lanes, strict=True), strict=True)
    return {f"pixel_{name}": sum(value << bits * lane for lane, value in enumerate(of)) for name, of in channels}


def verdict(
    table: Rectangles, index: int, eye, slope, mirror: tuple[int, int] | None, met: Collection[int]
) -> tuple[bool, int, int, bool]:
    """Apply the definition to a ray that seems to come from a mirrored eye.

    Args:
        table: sorted rectangles.
        index: index of the rectangle.
        eye: mirrored starting point of the ray.
        slope: slope with signs.
        mirror: axis and coordinate of the plane that the ray left last, or None.
        met: axes of all mirrors met in the point that the ray left last.

    Returns:
        True for a hit, n and e of t = n / e, and True for a hit in the point that the ray left last.
    """
    axis = int(table.axes[index])
    start = Fraction(int(mirror[1] - eye[mirror[0]]), int(slope[mirror[0]])) if mirror else 0
    origin = [int(place) + int(way) * start for place, way in zip(eye, slope, strict=True)]
    hit = exact_hit(table, index, origin, [int(way) for way in slope], frozenset(met) if mirror else None)
    n, e = abs(int(table.low[index, axis] - eye[axis])), abs(int(slope[axis]))
    return hit is not None, n, e, hit is not None and hit[0] == 0


def beside(random: np.random.Generator, place: int) -> int:
    """Return a coordinate changed by a power of two, or unchanged."""
    return int(np.clip(place + int(random.choice([-1, 0, 1])) * (1 << int(random.integers(9))), 0, WORLD_SIZE - 1))


def sharpened(random: np.random.Generator, table: Rectangles, index: int, eye, slope, mirror) -> Rectangles:
    """Return the table with a rectangle moved so that the decision is close: an edge to the hit point or next to it, or
    the plane to where the ray left the mirror."""
    axis, corners = int(table.axes[index]), table.corners.copy()
    if slope[axis] == 0:
        return table
    if mirror is not None and mirror[0] != axis and random.random() < 0.5:
        at_mirror = Fraction(int(mirror[1] - eye[mirror[0]]), int(slope[mirror[0]]))
        corners[index, :, axis] = np.clip(int(eye[axis] + int(slope[axis]) * at_mirror), 0, WORLD_SIZE - 1)
    if mirror is not None and mirror[0] == axis and random.random() < 0.3:
        corners[index, :, axis] = beside(random, mirror[1])
    t = Fraction(int(corners[index, 0, axis] - eye[axis]), int(slope[axis]))
    for u in OTHER_AXES[axis]:
        edge, past = int(random.integers(2)), int(random.integers(-1, 2))
        corners[index, edge, u] = np.clip(int(eye[u] + int(slope[u]) * t) + past, 0, WORLD_SIZE - 1)
        if random.random() < 0.7:
            corners[index, 1 - edge, u] = int(random.choice([0, WORLD_SIZE - 1]))
        if mirror is not None and mirror[0] == u and random.random() < 0.6:
            corners[index, edge, u] = beside(random, mirror[1])
    return Rectangles(corners, table.colours, table.enabled)
