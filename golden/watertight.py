# SPDX-License-Identifier: MIT
"""Rays aimed at edges and corners that rectangles share, which must not pass between the rectangles.

Like the watertightness tests of other ray tracers, but every ray meets its edge or corner exactly: slopes and
coordinates are integers, and the point is met at t = g / m, which no model computes. A leak is a ray that meets
nothing, or something beyond that point. Rays are aimed only where their surroundings are covered too, so a small error
of the ray is no excuse: between rectangles that lie, as seen from the eye, on opposite sides of their edge; at points
where four tiles meet; or anywhere in a closed room around the eye.

A closed rectangle contains its edges, and cross-multiplied comparisons of integers are exact. So a model that compares
that way finds both rectangles hit, at t = g / m or before, and has no leak.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.model import Model
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import BASIS_SCALE
from raycaster.screens import VIEW_DISTANCE

UNTURNED = 255
"""Greatest component of a slope of 9 signed bits."""

TURNED = 2 * BASIS_SCALE - 1
"""Greatest component of a basis vector. A turned camera's middle ray has 100 times its forward vector as its slope."""

EYES = 16
"""Number of eyes per table."""


@dataclass(frozen=True, eq=False)
class Aimed:
    """Rays of a table, aimed at shared edges and corners.

    Attributes:
        kind: kind of table, and of rays.
        turned: the slopes need a turned camera.
        rectangles: the table.
        cameras: int64 (rays, 3).
        slopes: int64 (rays, 3).
        eyes: int64 (rays, 3): the cameras, or their images in the mirror by which the rays reach their aims.
        images: int64 (rays, 3): the slopes, as seen from the eyes.
        reached: int64 (2, rays): numerator and denominator of t at the aim.
    """

    kind: str
    turned: bool
    rectangles: Rectangles
    cameras: np.ndarray
    slopes: np.ndarray
    eyes: np.ndarray
    images: np.ndarray
    reached: np.ndarray

    def leaks(self, model: Model) -> np.ndarray:
        """Return which rays leak, bool (rays,)."""
        reflections = int((self.eyes != self.cameras).any())
        traced = model.trace(self.rectangles, self.cameras, (0, 0, 0), self.slopes, reflections)
        winner = traced.winners[-1]
        rays, axis = np.arange(len(winner)), self.rectangles.axes[winner]
        slope = self.images[rays, axis]
        n = (self.rectangles.low[winner, axis] - self.eyes[rays, axis]) * np.sign(slope)
        g, m = self.reached
        return (winner < 0) | (n * m > g * np.abs(slope))


def suite(seed: int, tables: int, rays: int) -> Iterator[Aimed]:
    """Yield rays at this many tables of each kind, unturned and turned; fewer than `rays` each, where aims are hard."""
    for place in range(tables):
        rng = np.random.default_rng([seed, place])
        for kind, draw in (("grid", _grid), ("stairs", _stairs), ("room", _room), ("mirrored room", _room)):
            corners = draw(rng)
            inside = corners.min(axis=(0, 1)) + 1, corners.max(axis=(0, 1))
            cameras = rng.integers(*(inside if kind.endswith("room") else (0, WORLD_SIZE)), size=(EYES, 3))
            for turned in (False, True):
                yield _aimed(rng, kind, corners, cameras, turned, rays)


def _cuts(rng: np.random.Generator, low: int, high: int, parts: int) -> list[tuple[int, int]]:
    """Cut a length into parts at random."""
    inside = rng.choice(np.arange(low + 1, high), parts - 1, replace=False)
    return list(pairwise(sorted([low, *inside.tolist(), high])))


def _tiled(rng: np.random.Generator, low: np.ndarray, high: np.ndarray, parts: Sequence[int]) -> np.ndarray:
    """Return the corners, (tiles, 2, 3), of tiles that make up a rectangle, cut into parts in both directions."""
    [axis] = np.flatnonzero(low == high)
    u, v = OTHER_AXES[axis]
    tiles = []
    for across in _cuts(rng, low[u], high[u], parts[0]):
        for up in _cuts(rng, low[v], high[v], parts[1]):
            tile = np.array([low, low])
            tile[:, u], tile[:, v] = across, up
            tiles.append(tile)
    return np.array(tiles)


def _grid(rng: np.random.Generator) -> np.ndarray:
    """Draw a tiled rectangle in front of a greater one; corners (rectangles, 2, 3)."""
    low, high = rng.integers(60, 200, 3), rng.integers(300, 450, 3)
    axis = rng.integers(3)
    low[axis] = high[axis] = rng.integers(150, 350)
    behind = np.array([[0, 0, 0], [WORLD_SIZE - 1] * 3])
    behind[:, axis] = rng.choice([0, WORLD_SIZE - 1])
    return np.concatenate([_tiled(rng, low, high, (3, 3)), [behind]])


def _stairs(rng: np.random.Generator) -> np.ndarray:
    """Draw five steps that rise along x, in front of a wall."""
    x, z = (np.sort(rng.choice(np.arange(40, 480), 6, replace=False)) for _ in range(2))
    y = rng.integers(0, 150), rng.integers(350, WORLD_SIZE)
    steps = []
    for place in range(5):
        steps.append([[x[place], y[0], z[place]], [x[place], y[1], z[place + 1]]])
        steps.append([[x[place], y[0], z[place + 1]], [x[place + 1], y[1], z[place + 1]]])
    return np.array([*steps, [[WORLD_SIZE - 1, 0, 0], [WORLD_SIZE - 1] * 3]])


def _room(rng: np.random.Generator) -> np.ndarray:
    """Draw a closed room with tiled walls."""
    low, high = rng.integers(0, 200, 3), rng.integers(300, WORLD_SIZE, 3)
    walls = []
    for axis in range(3):
        for place in (low[axis], high[axis]):
            corners = np.array([low, high])
            corners[:, axis] = place
            walls.append(_tiled(rng, corners[0], corners[1], rng.integers(1, 3, 2).tolist()))
    return np.concatenate(walls)


def _seams(corners: np.ndarray, closed: bool) -> np.ndarray:
    """Return the shared edges and corners: rows of low (3), high (3), and the two rectangles."""
    found = []
    for one, other in combinations(range(len(corners)), 2):
        low, high = np.maximum(corners[one, 0], corners[other, 0]), np.minimum(corners[one, 1], corners[other, 1])
        if (low <= high).all() and (low < high).sum() <= 1:
            found.append([*low, *high, one, other])
            if closed:
                found += [[*end, *end, one, other] for end in (low, high)]
    return np.array(found)


def _aimed(
    rng: np.random.Generator, kind: str, corners: np.ndarray, cameras: np.ndarray, turned: bool, rays: int
) -> Aimed:
    """Aim rays at random shared edges and corners; those that would need unsuitable slopes are left out."""
    closed = kind.endswith("room")
    seams = _seams(corners, closed)
    low, high, pair = np.split(seams[rng.integers(len(seams), size=rays)], [3, 6], axis=1)
    cameras = cameras[rng.integers(len(cameras), size=rays)]
    eyes, mirror = cameras.copy(), corners[-1]
    if kind == "mirrored room":
        [axis] = np.flatnonzero(mirror[0] == mirror[1])
        eyes[:, axis] = 2 * mirror[0, axis] - eyes[:, axis]
    off = low - eyes
    along = np.where((low < high).any(axis=1), (high - low).argmax(axis=1), -1)
    line = np.arange(3) == along[:, None]
    g = np.gcd.reduce(np.where(line, 0, off), axis=1)
    steps = np.where(line, 0, off) // np.maximum(g, 1)[:, None]
    longest = np.maximum(np.abs(steps).max(axis=1), 1)
    limit = TURNED if turned else UNTURNED
    m = 1 + (rng.random(rays) * (limit // longest)).astype(np.int64)
    # Along the edge, the slope is any whole number between those of its ends, without them.
    first = np.take_along_axis(off, along[:, None], axis=1)[:, 0] * m // np.maximum(g, 1) + 1
    last = -(np.take_along_axis(eyes - high, along[:, None], axis=1)[:, 0] * m // np.maximum(g, 1)) - 1
    first, last = np.maximum(first, -limit), np.minimum(last, limit)
    free = first + (rng.random(rays) * (last - first + 1)).astype(np.int64)
    images = np.where(line, free[:, None], steps * m[:, None])
    good = (g > 0) & (longest <= limit) & ((along < 0) | (first <= last))
    slopes = images.copy()
    if kind == "mirrored room":
        slopes[:, axis] *= -1
        # The mirror is met strictly inside, and the aim is beyond.
        n, e = mirror[0, axis] - eyes[:, axis], images[:, axis]
        for u in OTHER_AXES[axis]:
            ends = (corners[:, :, u].min(), corners[:, :, u].max())
            place = eyes[:, u] * np.abs(e) + images[:, u] * n * np.sign(e)
            good &= (ends[0] * np.abs(e) < place) & (place < ends[1] * np.abs(e))
        good &= (n * e > 0) & (n * np.sign(e) * m < g * np.abs(e))
    if not closed:
        # An edge separates its rectangles, as seen from the eye, if they extend to opposite sides of the plane
        # through both; tiles that share a point surround it.
        normal = np.cross(line, off)
        sides = []
        for which in pair.T:
            wide = (corners[which, 0] < corners[which, 1]) & ~line
            upward = np.where(corners[which, 0] == low, 1, -1)
            sides.append(np.sign((normal * wide * upward).sum(axis=1)))
        good &= (along < 0) | (sides[0] * sides[1] < 0)
    if not turned:
        good &= slopes[:, 0] > 0
    scale = VIEW_DISTANCE if turned else 1
    count = len(corners)
    table = Rectangles(corners, np.full((count, 3), 255, np.uint8), np.ones(count, dtype=bool))
    return Aimed(
        kind, turned, table, cameras[good], scale * slopes[good], eyes[good], scale * images[good],
        np.array([g, scale * m])[:, good],
    )  # fmt: skip
