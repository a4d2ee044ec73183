# SPDX-License-Identifier: MIT
"""The image over the rationals: no division, no rounding, at any depth of reflection.

Two ideas replace the divisions. Bounds and depths are compared by cross-multiplication (Kensler and Shirley 2006). And
a ray that was reflected at plane k on axis a is taken as the straight ray from the eye mirrored in that plane,
E'[a] = 2 k - E[a] and D'[a] = -D[a], with the parameter t = n / e running on (Heckbert and Hanrahan 1984). So no hit
point is ever formed; what lies between the mirrored eye and the mirror is shut out by t > t of the mirror, or by t not
less than that where the ray may meet a second plane in the mirror's point, as it does in a corner.

Widths: after r reflections |E| and |n| are at most 511 (r + 1), and |e| and |D| at most the greatest slope, 190 for
primary rays of a camera that is not turned and below 2^19 of one that is. Every product is such a length times a slope.
Arrays are int64, so nothing overflows before slopes of 2^50.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from raycaster.golden.colour import blend, hit_colours
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import UNTURNED, Basis, Scene
from raycaster.screens import Screen


@dataclass(frozen=True)
class Bounce:
    """All that happened to every ray between two mirrors; in world units, seen from the mirrored eye.

    Rows of rectangles that are disabled or have no plane are all 0. Numerator and denominator are those
    of t = n / e, both negated where the slope along the axis is negative, so that the denominator is never negative.
    """

    eyes: np.ndarray
    """int64 (rays, 3): the camera, mirrored in all mirrors so far."""

    met: np.ndarray
    """bool (rays, 3): on which axes a plane through the ray's start is not hit: those of the mirrors that it met there,
    and all of a ray from the camera."""

    slopes: np.ndarray
    """int64 (rays, 3): slopes of the rays, with the reflections so far."""

    alive: np.ndarray
    """bool (rays,): has hit something that mirrors at every bounce before."""

    numerators: np.ndarray
    """int64 (rectangles, rays): n = plane - eye along the rectangle's axis, times the sign of e; positive is
    ahead, and 0 also where e is 0."""

    denominators: np.ndarray
    """int64 (rectangles, rays): |e|, the slope along the rectangle's axis; 0 for a parallel ray."""

    quotients: np.ndarray
    """int64 (rectangles, rays, 2): slope times n on u and v; divide by the denominator."""

    points: np.ndarray
    """int64 (rectangles, rays, 3): the point on the rectangle's plane; divide by the denominator."""

    depths: np.ndarray
    """int64 (rectangles, rays): |slope along x| times n, the way along x from the camera by all mirrors; divide by the
    denominator."""

    hits: np.ndarray
    """bool (rectangles, rays): ahead, beyond the last mirror or in a corner with it, and within the bounds."""

    winners: np.ndarray
    """int64 (rays,): index of the nearest rectangle hit, -1 for none."""


@dataclass(frozen=True)
class Trace:
    """What became of rays."""

    colours: np.ndarray
    """uint8 (rays, 3)."""

    winners: tuple[np.ndarray, ...]
    """For the primary ray and each reflection, int64 (rays,): index of the rectangle hit, -1 for none and after what
    does not mirror."""

    seen: tuple[np.ndarray, ...]
    """For the primary ray and each reflection, uint8 (rays, 3): the colour of what was hit, the background for none."""

    points: tuple[np.ndarray, ...]
    """For the primary ray and each reflection, int64 (rays, 3): where it hit, in world units times the denominator."""

    denominators: tuple[np.ndarray, ...]
    """For the primary ray and each reflection, int64 (rays,): |slope| along the axis of what was hit, 0 for a miss."""

    bounces: tuple[Bounce, ...]
    """For the primary ray and each reflection; empty unless it was to be kept."""


def render(scene: Scene, screen: Screen, reflections: int | None = None) -> np.ndarray:
    """The picture of a scene.

    Args:
        scene: what is seen; its `rows` are not looked at.
        screen: what it is looked at through.
        reflections: instead of the scene's own.

    Returns:
        uint8 (rows, columns, 3).
    """
    reflections = scene.reflections if reflections is None else reflections
    camera = scene.camera
    return picture(
        screen, Rectangles.of_scene(scene), camera.position, scene.background, reflections, basis=camera.basis
    )


def picture(
    screen: Screen,
    rectangles: Rectangles,
    camera: Sequence[int] | np.ndarray,
    background: Sequence[int],
    reflections: int,
    *,
    basis: Basis = UNTURNED,
) -> np.ndarray:
    """The same of what a scene comes down to; the arguments are those of `trace` and `primary_slopes`."""
    slopes = primary_slopes(screen, basis)
    return trace(rectangles, camera, background, slopes.reshape(-1, 3), reflections).colours.reshape(slopes.shape)


def trace(
    rectangles: Rectangles,
    camera: Sequence[int] | np.ndarray,
    background: Sequence[int],
    slopes: np.ndarray,
    reflections: int,
    *,
    keep: bool = False,
) -> Trace:
    """Follow rays to their last reflection.

    Args:
        rectangles: the table.
        camera: (3,) or, one a ray, (rays, 3): where the rays start, in world units.
        background: red, green, blue.
        slopes: int (rays, 3); only their ratios count.
        reflections: 0 or more.
        keep: also return every intermediate value: some 100 bytes a ray, rectangle and bounce.
    """
    slope = np.array(np.asarray(slopes).T, dtype=np.int64, order="C")
    eye = np.array(np.broadcast_to(np.asarray(camera), slope.T.shape).T, dtype=np.int64, order="C")
    mirror_t = np.zeros(slope.shape[1], dtype=np.int64), np.ones(slope.shape[1], dtype=np.int64)
    met = np.ones(slope.shape, dtype=bool)
    alive = np.ones(slope.shape[1], dtype=bool)
    winners, seen, points, denominators, bounces = [], [], [], [], []
    for _ in range(reflections + 1):
        bounce = _empty_bounce(rectangles, eye, slope, met, alive) if keep else None
        winner, (numerator, denominator) = _nearest(rectangles, eye, slope, mirror_t, met, bounce=bounce)
        winners.append(winner)
        points.append((eye * denominator + slope * numerator).T)
        denominators.append(denominator)
        seen.append(hit_colours(rectangles, background, winner, points[-1], denominator))
        if bounce:
            bounce.winners[:] = winner
            bounces.append(bounce)
        alive = (winner >= 0) & (rectangles.mirrors[winner] > 0)
        met &= numerator * mirror_t[1] == mirror_t[0] * denominator
        for axis in range(3):
            mirrored = alive & (rectangles.axes[winner] == axis)
            eye[axis, mirrored] = 2 * rectangles.low[winner[mirrored], axis] - eye[axis, mirrored]
            slope[axis, mirrored] *= -1
            met[axis, mirrored] = True
        # Nothing lies beyond 1 / 0.
        mirror_t = np.where(alive, numerator, 1), np.where(alive, denominator, 0)
    colours = blend(seen, [rectangles.mirrors[winner] for winner in winners])
    return Trace(colours, tuple(winners), tuple(seen), tuple(points), tuple(denominators), tuple(bounces))


def _nearest(
    rectangles: Rectangles,
    eye: np.ndarray,
    slope: np.ndarray,
    mirror_t: tuple[np.ndarray, np.ndarray],
    met: np.ndarray,
    *,
    bounce: Bounce | None,
) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """The nearest rectangle from the last mirror on and its t, as numerator and denominator; arrays are ([3,] rays)."""
    mirror_n, mirror_e = mirror_t
    sign, magnitude = np.sign(slope), np.abs(slope)
    winner = np.full(eye.shape[1], -1, dtype=np.int64)
    # 1 / 0 lies beyond every t.
    best_n, best_e = np.ones_like(winner), np.zeros_like(winner)
    for index in np.flatnonzero(rectangles.visible):
        axis = rectangles.axes[index]
        low, high = rectangles.low[index], rectangles.high[index]
        n = (low[axis] - eye[axis]) * sign[axis]
        e = magnitude[axis]
        # False for n <= 0, as the first "mirror" stands at t = 0 / 1 and all its axes are met; and for a ray that has
        # ended, as its last one stands at 1 / 0.
        along, along_mirror = n * mirror_e, mirror_n * e
        hit = (e > 0) & ((along > along_mirror) | ((along == along_mirror) & ~met[axis]))
        for u in OTHER_AXES[axis]:
            way = slope[u] * n
            hit &= ((low[u] - eye[u]) * e <= way) & (way <= (high[u] - eye[u]) * e)
        # Strict, so the lower index wins a tie.
        nearer = hit & (n * best_e < best_n * e)
        winner[nearer] = index
        np.copyto(best_n, n, where=nearer)
        np.copyto(best_e, e, where=nearer)
        if bounce:
            ways = slope * n
            bounce.numerators[index] = n
            bounce.denominators[index] = e
            bounce.quotients[index] = ways[list(OTHER_AXES[axis])].T
            bounce.points[index] = (eye * e + ways).T
            bounce.depths[index] = magnitude[0] * n
            bounce.hits[index] = hit
    return winner, (best_n, best_e)


def _empty_bounce(
    rectangles: Rectangles, eye: np.ndarray, slope: np.ndarray, met: np.ndarray, alive: np.ndarray
) -> Bounce:
    shape = len(rectangles), len(alive)
    return Bounce(
        eyes=eye.T.copy(),
        slopes=slope.T.copy(),
        met=met.T.copy(),
        alive=alive.copy(),
        numerators=np.zeros(shape, dtype=np.int64),
        denominators=np.zeros(shape, dtype=np.int64),
        quotients=np.zeros((*shape, 2), dtype=np.int64),
        points=np.zeros((*shape, 3), dtype=np.int64),
        depths=np.zeros(shape, dtype=np.int64),
        hits=np.zeros(shape, dtype=bool),
        winners=np.empty(len(alive), dtype=np.int64),
    )
