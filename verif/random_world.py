# SPDX-License-Identifier: MIT
"""Random tables, cameras and rays for tests, drawn so that rare cases are common: ties, edges, cameras in planes."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.world import Rectangles
from raycaster.scene import BASIS_SCALE, CELLS, PATTERNS, Basis, Camera, Light
from raycaster.screens import VIEW_DISTANCE

EXTREMES = (0, 1, 255, 256, 510, 511)
"""Coordinates next to a bound or a carry."""

ROOM = [((0, 0, 0), tuple(0 if axis == plane else 511 for axis in range(3))) for plane in range(3)]
ROOM += [(tuple(511 if axis == plane else 0 for axis in range(3)), (511, 511, 511)) for plane in range(3)]
"""Corners of the six walls of the whole world, within which every ray hits something."""


def random_rectangles(rng: np.random.Generator, count: int = 12, closed: bool | None = None) -> Rectangles:
    """Draw a table of rectangles, most with a plane and enabled, including lines, points and coincident rectangles.

    Args:
        rng: random source.
        count: number of rectangles; 7 or more if closed.
        closed: True includes the six walls of the world, all enabled; None leaves it to chance.
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
    """Draw a camera, int64 (3,), in the world and often in a rectangle's plane or at its edge."""
    corners = rectangles.corners.reshape(-1, 3)
    near = corners[rng.integers(len(corners), size=3), [0, 1, 2]]
    return np.where(rng.random(3) < 0.4, near, rng.integers(WORLD_SIZE, size=3))


def random_light(rng: np.random.Generator, rectangles: Rectangles, camera: np.ndarray) -> Light:
    """Draw a light of any shade: anywhere, in planes and on edges, close to one of them, or at the camera."""
    position = random_camera(rng, rectangles)
    if rng.random() < 0.1:
        position = camera
    elif rng.random() < 0.3:
        position = np.clip(position + rng.integers(-1, 2, 3), 0, WORLD_SIZE - 1)
    x, y, z = position.tolist()
    return Light(position=(x, y, z), shade=int(rng.integers(4)) / 4)


def random_slopes(rng: np.random.Generator, rays: int) -> np.ndarray:
    """Draw slopes, int64 (rays, 3): half as in primary rays, half any of 9 signed bits; 0 only along y and z."""
    primary = np.stack(
        [np.full(rays, VIEW_DISTANCE), rng.integers(-160, 160, rays), rng.integers(-49, 191, rays)], axis=1
    )
    steep = rng.choice([1, 2, 99, 100, 127, 128, 255], (rays, 3)) * rng.choice([-1, 1], (rays, 3))
    slopes = np.where(rng.random((rays, 1)) < 0.5, primary, steep)
    slopes[:, 1:][rng.random((rays, 2)) < 0.1] = 0
    return slopes


def random_grid(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw a room and its contents on a grid, so that rays on diagonals run into corners.

    Args:
        rng: random source.
        count: number of rectangles, 6 or more.

    Returns:
        Corners, int64 (count, 2, 3), of rectangles with a plane, and a camera, int64 (3,), on the grid too; half of the
        cameras are on a diagonal of the room.
    """
    low, high = rng.integers(0, 5, 3), rng.integers(8, 16, 3)
    corners = np.concatenate([np.tile([low, high], (6, 1, 1)), rng.integers(low, high + 1, (count - 6, 2, 3))])
    flat = np.concatenate([[0, 0, 1, 1, 2, 2], rng.integers(3, size=count - 6)])
    index = np.arange(count)
    corners[index, index % 2, flat] = corners[index, 1 - index % 2, flat]
    place = rng.integers(low, high) if rng.random() < 0.5 else low + rng.integers(1, 4)
    return 32 * rng.permutation(corners), 32 * place


def random_looks(rng: np.random.Generator, rectangles: Rectangles) -> Rectangles:
    """Return rectangles with random mirrors and patterns, most often half and plain."""
    count = len(rectangles)
    return replace(
        rectangles,
        mirrors=np.where(rng.random(count) < 0.4, 2, rng.integers(5, size=count)),
        kinds=np.where(rng.random(count) < 0.4, 0, rng.integers(len(PATTERNS), size=count)),
        cells=rng.choice(CELLS, count),
        colours_2=rng.integers(256, size=(count, 3)).astype(np.uint8),
    )


def random_basis(rng: np.random.Generator) -> Basis:
    """Draw forward, right and up of a camera.

    Four kinds are equally frequent: turned by any angles, turned by whole right angles, along axes with any signs and
    lengths, and anything that the registers can hold.
    """
    kind = rng.integers(4)
    if kind == 0:
        yaw, pitch, roll = rng.uniform(-180, 180, 3).tolist()
        return Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis
    if kind == 1:
        yaw, pitch, roll = (90.0 * rng.integers(-2, 3, 3)).tolist()
        return Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis
    low, high = -2 * BASIS_SCALE, 2 * BASIS_SCALE
    if kind == 2:
        order = rng.choice(list(permutations(range(3))))
        vectors = np.eye(3, dtype=np.int64)[order] * rng.choice([low, -BASIS_SCALE, 1, BASIS_SCALE, high - 1], (3, 1))
    else:
        extremes = rng.choice([low, -1, 0, 1, high - 1], (3, 3))
        vectors = np.where(rng.random((3, 3)) < 0.5, extremes, rng.integers(low, high, (3, 3)))
    forward, right, up = (tuple(vector) for vector in vectors.tolist())
    return forward, right, up
