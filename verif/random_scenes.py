# SPDX-License-Identifier: MIT
"""Random scenes for soak tests of the whole design, in styles that stress different parts."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.world import Rectangles
from raycaster.scene import PATTERNS, Camera, Rectangle, Scene
from raycaster.verif.random_world import (
    EXTREMES,
    ROOM,
    random_camera,
    random_grid,
    random_light,
    random_looks,
    random_rectangles,
)

STYLES = ("room", "boxes", "slits", "degenerate", "extreme", "corners")


def style_of(seed: int) -> str:
    """Return the style of a seed's scene; the styles take turns."""
    return STYLES[seed % len(STYLES)]


def random_scene(seed: int, rectangles: int, reflections: int, features: Collection[str] = ()) -> Scene:
    """Generate the scene of a seed; its title has the seed and the style.

    Args:
        seed: the same seed always gives the same scene.
        rectangles: maximum number of rectangles, 1 or more.
        reflections: maximum number of reflections.
        features: options of `FEATURES` that the scene may need; the rest of it does not depend on them.
    """
    rng = np.random.default_rng(seed)
    style = style_of(seed)
    corners, camera = _corners(rng, style, rectangles)
    table = Rectangles(corners, rng.integers(256, size=(len(corners), 3)).astype(np.uint8), np.ones(len(corners), bool))
    bounces, background = int(rng.integers(reflections + 1)), tuple(rng.integers(256, size=3).tolist())
    if camera is None:
        camera = random_camera(rng, table)
    angles = _angles(rng) if "turn" in features else {}
    table = random_looks(rng, table)
    light = random_light(rng, table, camera) if "light" in features and rng.random() < 0.9 else None
    return Scene(
        title=f"{style} of seed {seed}",
        reflections=bounces,
        background=background,
        camera=Camera(position=tuple(camera.tolist()), **angles),
        light=light,
        rect=tuple(rectangle_of(table, index, features) for index in range(len(table))),
    )


def _angles(rng: np.random.Generator) -> dict[str, float]:
    """Return random angles, or multiples of 15 degrees, which include right angles."""
    some = rng.uniform(-180, 180, 3) if rng.random() < 0.5 else 15.0 * rng.integers(-12, 13, 3)
    return dict(zip(("yaw", "pitch", "roll"), np.where(rng.random(3) < 0.2, 0, some).tolist(), strict=True))


def rectangle_of(table: Rectangles, index: int, features: Collection[str] = ()) -> Rectangle:
    """Return a table's rectangle as in a scene file, with its look as far as the design has it."""
    corners, colour = table.corners[index].tolist(), tuple(table.colours[index].tolist())
    entries: dict[str, object] = {"corners": corners, "colour": colour}
    if "materials" in features:
        entries["mirror"] = int(table.mirrors[index]) / 4
    if "patterns" in features and table.kinds[index]:
        entries |= {"pattern": PATTERNS[table.kinds[index]], "cell": int(table.cells[index])}
        entries["colour2"] = tuple(table.colours_2[index].tolist())
    return Rectangle.model_validate(entries)


def _corners(rng: np.random.Generator, style: str, count: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Return corners, int64 (rectangles, 2, 3), each pair with a plane, and the camera, int64 (3,), if it matters."""
    camera = None
    if style == "corners":
        corners, camera = random_grid(rng, max(count, len(ROOM)))
    elif style == "degenerate":
        # A closed room takes six rectangles, and one more to see in it.
        table = random_rectangles(rng, count, closed=None if count > len(ROOM) else False)
        corners = table.corners[table.visible]
    elif style == "extreme":
        corners = _flatten(rng, rng.choice(EXTREMES, (count, 2, 3)))
    elif style == "slits":
        corners = _flatten(rng, rng.integers(WORLD_SIZE, size=(count, 2, 3)))
        thin = np.arange(count), rng.integers(3, size=count)
        corners[(thin[0], 1, thin[1])] = np.minimum(corners[(thin[0], 0, thin[1])] + rng.integers(2, size=count), 511)
        corners = _flatten(rng, corners)
    elif style == "boxes":
        corners = np.concatenate([_box(rng) for _ in range(-(-count // 6))])[:count]
    else:
        inside = _flatten(rng, rng.integers(WORLD_SIZE, size=(count, 2, 3)))
        corners = np.concatenate([np.array(ROOM), inside])[:count]
    return rng.permutation(corners)[:count] if len(corners) else np.zeros((1, 2, 3), np.int64), camera


def _flatten(rng: np.random.Generator, corners: np.ndarray) -> np.ndarray:
    """Give each pair of corners a plane on a random axis."""
    flat = rng.integers(3, size=len(corners))
    index = np.arange(len(corners))
    corners[index, 1, flat] = corners[index, 0, flat]
    return corners


def _box(rng: np.random.Generator) -> np.ndarray:
    """Return the six sides of a random box; int64 (6, 2, 3)."""
    low, high = np.sort(rng.integers(WORLD_SIZE, size=(2, 3)), axis=0)
    sides = np.broadcast_to([low, high], (6, 2, 3)).copy()
    for axis in range(3):
        sides[2 * axis, 1, axis] = low[axis]
        sides[2 * axis + 1, 0, axis] = high[axis]
    return sides
