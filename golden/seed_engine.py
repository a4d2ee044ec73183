# SPDX-License-Identifier: MIT
"""Bit for bit what the divide-per-rectangle hardware computes.

Origins, planes and hit points are fixed-point numbers with F fraction bits: integers in units of 2^-F. Each coordinate
of a hit point costs one division of magnitudes. Its quotient is rounded, and reflected rays start at the rounded point:
that is the engine's only error.

Widths: |n| < 2^(9 + F) and |slope| is at most 190 for primary rays of the screens at hand, so dividends stay below
2^(17 + F), and within 2^25 at F = 8. Arrays are int64, so nothing overflows before slopes of 2^40.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from raycaster.configuration import COORDINATE_BITS, Rounding
from raycaster.golden.colour import blend, hit_colours
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import Scene
from raycaster.screens import Screen


@dataclass(frozen=True)
class Bounce:
    """All that happened to every ray between two mirrors; in units of 2^-F, but for slopes, which are in world units.

    Rows of rectangles that are disabled or have no plane are all 0.
    """

    origins: np.ndarray
    """int64 (rays, 3): the camera, or the last hit point as stored, where a ray that has ended stays."""

    slopes: np.ndarray
    """int64 (rays, 3): slopes of the rays, with the reflections so far."""

    alive: np.ndarray
    """bool (rays,): has hit something that mirrors at every bounce before."""

    numerators: np.ndarray
    """int64 (rectangles, rays): n = plane - origin along the rectangle's axis, signed."""

    denominators: np.ndarray
    """int64 (rectangles, rays): e, the signed slope along the rectangle's axis, in world units."""

    quotients: np.ndarray
    """int64 (rectangles, rays, 2): magnitudes |slope n / e| on u and v, rounded; 0 where not valid."""

    valid: np.ndarray
    """bool (rectangles, rays, 2): that there is such a coordinate on u and on v; see `intersect`."""

    points: np.ndarray
    """int64 (rectangles, rays, 3): the point on the rectangle's plane; 0 on u and v where not valid."""

    depths: np.ndarray
    """int64 (rectangles, rays): |point - origin| along x; means something where hit."""

    hits: np.ndarray
    """bool (rectangles, rays): the ray is alive, and both coordinates are valid and within the bounds."""

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
    """For the primary ray and each reflection, int64 (rays, 3): where it hit, in units of 2^-F; for a miss, where it
    started."""

    bounces: tuple[Bounce, ...]
    """For the primary ray and each reflection; empty unless it was to be kept."""


def divide(
    numerator: ArrayLike, denominator: ArrayLike, fraction_bits: int = 0, rounding: Rounding = "truncate"
) -> tuple[np.ndarray, np.ndarray]:
    """The divider: numerator / denominator, of magnitudes.

    Args:
        numerator: int, 0 or more; it carries the quotient's fraction bits already, so it is not shifted here.
        denominator: int, 0 or more.
        fraction_bits: F; the quotient has 9 + F bits.
        rounding: toward zero or to nearest, halves up.

    Returns:
        The quotient, int64, and the overflow, bool: denominator 0 or a quotient, once rounded, of more than 9 + F bits.
        The quotient is 0 where it overflows. Both have the arguments' common shape.

    Raises:
        ValueError: no such rounding.
    """
    numerator, denominator = np.asarray(numerator, dtype=np.int64), np.asarray(denominator, dtype=np.int64)
    divisor = np.maximum(denominator, 1)
    if rounding == "truncate":
        quotient = numerator // divisor
    elif rounding == "nearest":
        quotient = (2 * numerator + divisor) // (2 * divisor)
    else:
        raise ValueError(f"rounding must be truncate or nearest, not {rounding!r}")
    overflow = (denominator == 0) | (quotient >= 1 << (COORDINATE_BITS + fraction_bits))
    return np.where(overflow, 0, quotient), overflow


def intersect(
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    d: ArrayLike,
    e: ArrayLike,
    fraction_bits: int = 0,
    rounding: Rounding = "truncate",
) -> tuple[np.ndarray, np.ndarray]:
    """One coordinate of a hit point: a + b (c - d) / e.

    Args:
        a: the origin on this axis, in units of 2^-F.
        b: the slope on this axis, in world units.
        c: the rectangle's plane, in units of 2^-F.
        d: the origin on the plane's axis, in units of 2^-F.
        e: the slope on the plane's axis, in world units.
        fraction_bits: F.
        rounding: of the quotient.

    Returns:
        The coordinate, int64 in units of 2^-F, and whether it is valid, bool: the plane is ahead (e and c - d have one
        sign, and neither is 0) and the quotient |b| |c - d| / |e| does not overflow. The coordinate may lie outside the
        world; it is 0 where not valid.
    """
    b, e = np.asarray(b, dtype=np.int64), np.asarray(e, dtype=np.int64)
    n = np.asarray(c, dtype=np.int64) - np.asarray(d, dtype=np.int64)
    quotient, overflow = divide(np.abs(b) * np.abs(n), np.abs(e), fraction_bits, rounding)
    valid = (np.sign(n) * np.sign(e) > 0) & ~overflow
    return np.where(valid, a + np.sign(b) * quotient, 0), valid


def render(
    scene: Scene,
    screen: Screen,
    fraction_bits: int = 0,
    rounding: Rounding = "truncate",
    reflections: int | None = None,
) -> np.ndarray:
    """The picture of a scene.

    Args:
        scene: what is seen; its `rows` are not looked at.
        screen: what it is looked at through.
        fraction_bits: F, 0..8.
        rounding: of quotients.
        reflections: instead of the scene's own.

    Returns:
        uint8 (rows, columns, 3).

    Raises:
        ValueError: the camera is turned.
    """
    if scene.camera.turned:
        raise ValueError("depth is measured along x; the camera cannot turn")
    slopes = primary_slopes(screen)
    traced = trace(
        Rectangles.of_scene(scene),
        scene.camera.position,
        scene.background,
        slopes.reshape(-1, 3),
        scene.reflections if reflections is None else reflections,
        fraction_bits=fraction_bits,
        rounding=rounding,
    )
    return traced.colours.reshape(slopes.shape)


def trace(
    rectangles: Rectangles,
    camera: Sequence[int] | np.ndarray,
    background: Sequence[int],
    slopes: np.ndarray,
    reflections: int,
    *,
    fraction_bits: int = 0,
    rounding: Rounding = "truncate",
    keep: bool = False,
) -> Trace:
    """Follow rays to their last reflection.

    Args:
        rectangles: the table.
        camera: (3,) or, one a ray, (rays, 3): where the rays start, in world units.
        background: red, green, blue.
        slopes: int (rays, 3), in world units.
        reflections: 0 or more.
        fraction_bits: F, 0..8.
        rounding: of quotients.
        keep: also return every intermediate value: some 100 bytes a ray, rectangle and bounce.
    """
    slope = np.array(np.asarray(slopes).T, dtype=np.int64, order="C")
    origin = np.array(np.broadcast_to(np.asarray(camera), slope.T.shape).T, dtype=np.int64, order="C") << fraction_bits
    alive = np.ones(slope.shape[1], dtype=bool)
    winners, seen, points, bounces = [], [], [], []
    for _ in range(reflections + 1):
        bounce = _empty_bounce(rectangles, origin, slope, alive) if keep else None
        winner, origin = _nearest(
            rectangles, origin, slope, alive, fraction_bits=fraction_bits, rounding=rounding, bounce=bounce
        )
        winners.append(winner)
        points.append(origin.T)
        seen.append(hit_colours(rectangles, background, winner, points[-1], 1 << fraction_bits))
        if bounce:
            bounce.winners[:] = winner
            bounces.append(bounce)
        alive = (winner >= 0) & (rectangles.mirrors[winner] > 0)
        for axis in range(3):
            slope[axis, alive & (rectangles.axes[winner] == axis)] *= -1
    colours = blend(seen, [rectangles.mirrors[winner] for winner in winners])
    return Trace(colours, tuple(winners), tuple(seen), tuple(points), tuple(bounces))


def _nearest(
    rectangles: Rectangles,
    origin: np.ndarray,
    slope: np.ndarray,
    alive: np.ndarray,
    *,
    fraction_bits: int,
    rounding: Rounding,
    bounce: Bounce | None,
) -> tuple[np.ndarray, np.ndarray]:
    """The nearest rectangle and the point where it is hit; arrays are ([3,] rays).

    For a miss, and a ray that is not alive, -1 and the origin itself.
    """
    winner = np.full(origin.shape[1], -1, dtype=np.int64)
    best_depth = np.full(origin.shape[1], 1 << (COORDINATE_BITS + fraction_bits), dtype=np.int64)
    best_point = origin.copy()
    point = np.empty_like(origin)
    for index in np.flatnonzero(rectangles.visible):
        axis = rectangles.axes[index]
        low, high = rectangles.low[index] << fraction_bits, rectangles.high[index] << fraction_bits
        plane = low[axis]
        point[axis] = plane
        hit = alive.copy()
        validities = []
        for u in OTHER_AXES[axis]:
            point[u], valid = intersect(origin[u], slope[u], plane, origin[axis], slope[axis], fraction_bits, rounding)
            hit &= valid & (low[u] <= point[u]) & (point[u] <= high[u])
            validities.append(valid)
        depth = np.abs(point[0] - origin[0])
        # Strict, so the lower index wins a tie.
        nearer = hit & (depth < best_depth)
        winner[nearer] = index
        np.copyto(best_depth, depth, where=nearer)
        np.copyto(best_point, point, where=nearer)
        if bounce:
            extent = list(OTHER_AXES[axis])
            bounce.numerators[index] = plane - origin[axis]
            bounce.denominators[index] = slope[axis]
            bounce.valid[index] = np.transpose(validities)
            bounce.quotients[index] = np.abs(point - origin)[extent].T * bounce.valid[index]
            bounce.points[index] = point.T
            bounce.depths[index] = depth
            bounce.hits[index] = hit
    return winner, best_point


def _empty_bounce(rectangles: Rectangles, origin: np.ndarray, slope: np.ndarray, alive: np.ndarray) -> Bounce:
    shape = len(rectangles), len(alive)
    return Bounce(
        origins=origin.T.copy(),
        slopes=slope.T.copy(),
        alive=alive.copy(),
        numerators=np.zeros(shape, dtype=np.int64),
        denominators=np.zeros(shape, dtype=np.int64),
        quotients=np.zeros((*shape, 2), dtype=np.int64),
        valid=np.zeros((*shape, 2), dtype=bool),
        points=np.zeros((*shape, 3), dtype=np.int64),
        depths=np.zeros(shape, dtype=np.int64),
        hits=np.zeros(shape, dtype=bool),
        winners=np.empty(len(alive), dtype=np.int64),
    )
