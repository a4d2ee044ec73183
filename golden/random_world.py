# SPDX-License-Identifier: MIT
"""Random tables, cameras and rays for tests, drawn so that rare cases are common: ties, edges, planes stood on."""

from __future__ import annotations

import numpy as np

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.world import Rectangles
from raycaster.screens import VIEW_DISTANCE

EXTREMES = (0, 1, 255, 256, 510, 511)
"""Coordinates next to a bound or a carry."""

ROOM = [((0, 0, 0), tuple(0 if axis == plane else 511 for axis in range(3))) for plane in range(3)]
ROOM += [(tuple(511 if axis == plane else 0 for axis in range(3)), (511, 511, 511)) for plane in range(3)]
"""Corners of the six walls of the whole world, from within which every ray hits something."""


def random_rectangles(rng: np.random.Generator, count: int = 12, closed: bool | None = None) -> Rectangles:
    """A table of `count` rectangles, most with a plane and enabled; lines, points and coincident ones among them.

    Args:
        rng: the source.
        count: length of the table; 7 or more where closed.
        closed: with the six walls of the world among them, all enabled; None leaves it to chance.
    """
    # Few different coordinates, so that planes and edges are shared.
    pool = np.concatenate([rng.choice(EXTREMES, 3), rng.integers(WORLD_SIZE, size=3)])
    wide = rng.integers(WORLD_SIZE, size=(count, 2, 3))
    corners = np.where(rng.random((count, 2, 3)) < 0.6, rng.choice(pool, (count, 2, 3)), wide)
    flat = rng.integers(3, size=count)
    keep_plane = rng.random(count) < 0.9
    index = np.arange(count)[keep_plane]
    corners[index, 1, flat[keep_plane]] = corners[index, 0, flat[keep_plane]]
    twins = rng.integers(count, size=(2, count // 4))
    corners[twins[0]] = corners[twins[1]]
    enabled = rng.random(count) < 0.9
    if rng.random() < 0.5 if closed is None else closed:
        places = rng.permutation(count)[:6]
        corners[places] = ROOM
        enabled[places] = True
    colours = rng.integers(256, size=(count, 3)).astype(np.uint8)
    return Rectangles(corners.astype(np.int64), colours, enabled)


def random_camera(rng: np.random.Generator, rectangles: Rectangles) -> np.ndarray:
    """int64 (3,): in the world, and often on a rectangle's plane or at its edge."""
    corners = rectangles.corners.reshape(-1, 3)
    near = corners[rng.integers(len(corners), size=3), [0, 1, 2]]
    return np.where(rng.random(3) < 0.4, near, rng.integers(WORLD_SIZE, size=3))


def random_slopes(rng: np.random.Generator, rays: int) -> np.ndarray:
    """int64 (rays, 3): half as primary rays have them, half anything of 9 signed bits; 0 only along y and z."""
    primary = np.stack(
        [np.full(rays, VIEW_DISTANCE), rng.integers(-160, 160, rays), rng.integers(-49, 191, rays)], axis=1
    )
    steep = rng.choice([1, 2, 99, 100, 127, 128, 255], (rays, 3)) * rng.choice([-1, 1], (rays, 3))
    slopes = np.where(rng.random((rays, 1)) < 0.5, primary, steep)
    slopes[:, 1:][rng.random((rays, 2)) < 0.1] = 0
    return slopes
