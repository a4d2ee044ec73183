# SPDX-License-Identifier: MIT
"""How far the seed engine's rounding leads from the exact picture, ray by ray, and how far it may.

An intersection forms P[u] = O[u] + D[u] (k - O[a]) / e. The plane k is exact, so an origin that is off by d[u] and d[a]
puts the point off by at most

    d'[u] = d[u] + |D[u] / e| d[a] + q,    d'[a] = 0,

where q is what the quotient's rounding adds: one unit in the last place for truncation, half of one for nearest. The
primary ray starts from d = 0. It is standard forward error analysis (Higham 2002, chapter 1), and holds for a ray as
long as it hits what the exact ray hits; where it does not, it has flipped, and is counted instead.

Everything is compared as integers: distances over a denominator in which all slopes passed so far are multiplied
together, with 2^(F + 1) for the half.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from raycaster.configuration import Rounding
from raycaster.golden.exact import ExactModel
from raycaster.golden.model import Trace
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import OTHER_AXES, Rectangles

NEAR = 1e-9
"""Parts by which two quotients in floating point may be off, many times over."""


@dataclass(frozen=True)
class DepthErrors:
    """The rays of one depth of reflection, 0 for primary rays, of those that have not flipped before."""

    rays: int
    """That hit what the exact ray hits."""

    flips: int
    """That hit something else, or nothing, or something where the exact ray hits nothing."""

    worst: float
    """Greatest error of a coordinate of a hit point, in world units; 0 where no ray hit."""

    mean: float
    """Mean over the rays of each one's greatest error of a coordinate, in world units; 0 where no ray hit."""

    bound: float
    """Greatest of the errors that the rays might have, in world units."""

    tightest: float
    """Greatest part of its bound that a coordinate's error reaches; more than 1 would be wrong."""

    exceeded: int
    """Coordinates whose error is more than their bound."""


def compare(
    rectangles: Rectangles,
    camera: Sequence[int],
    slopes: np.ndarray,
    reflections: int,
    fraction_bits: int,
    rounding: Rounding,
) -> tuple[DepthErrors, ...]:
    """Trace rays both ways and compare; see `depth_errors`.

    Args:
        rectangles: the table.
        camera: where the rays start, in world units.
        slopes: int (rays, 3), none 0 along x.
        reflections: 0 or more.
        fraction_bits: F.
        rounding: of quotients.
    """
    dark = (0, 0, 0)
    perfect, rounded = (
        model.trace(rectangles, camera, dark, slopes, reflections)
        for model in (ExactModel(), SeedModel(fraction_bits, rounding))
    )
    return depth_errors(rectangles, slopes, perfect, rounded.winners, rounded.points, fraction_bits, rounding)


def depth_errors(
    rectangles: Rectangles,
    slopes: np.ndarray,
    perfect: Trace,
    winners: Sequence[np.ndarray],
    points: Sequence[np.ndarray],
    fraction_bits: int,
    rounding: Rounding,
) -> tuple[DepthErrors, ...]:
    """Hold hit points against the exact ones and against their bounds.

    Args:
        rectangles: the table.
        slopes: int (rays, 3), of the primary rays.
        perfect: what they meet.
        winners: for each depth, int64 (rays,): what they met, as `Trace` has it.
        points: for each depth, int64 (rays, 3): where, in units of 2^-F.
        fraction_bits: F.
        rounding: of quotients.

    Returns:
        By depth of reflection, the primary rays first.
    """
    # Slopes only change signs, so the magnitudes serve all depths.
    magnitude = np.abs(np.asarray(slopes)).T
    # A bound's numerator at most doubles with each depth beside the slope that it is multiplied with, and starts at 4.
    if len(winners) * math.log2(2 * magnitude.max()) + 2 >= 63:
        # Python's own integers, which take a hundred times as long.
        magnitude = magnitude.astype(object)
    scale = 1 << fraction_bits
    last_place = 2 if rounding == "truncate" else 1
    # A bound is `allowed` / (`common` * 2 * scale).
    allowed = np.zeros_like(magnitude)
    common = np.ones_like(magnitude[0])
    same = np.ones(magnitude.shape[1], dtype=bool)
    found = []
    for depth, winner in enumerate(winners):
        agree = same & (winner == perfect.winners[depth])
        flips = int((same & ~agree).sum())
        same = agree
        axes = rectangles.axes[winner]
        hit = agree & (winner >= 0)
        allowed, common = _next_bound(allowed, common, magnitude, axes, hit, last_place)
        denominator = perfect.denominators[depth]
        # Errors over denominator * scale.
        off = np.abs(points[depth].T * denominator - perfect.points[depth].T * scale)
        found.append(_summary(off, allowed, common, denominator, hit, flips, scale))
        # A ray that hits nothing has ended, and agrees from then on.
        same = hit
    return tuple(found)


def _next_bound(
    allowed: np.ndarray,
    common: np.ndarray,
    magnitude: np.ndarray,
    axes: np.ndarray,
    hit: np.ndarray,
    last_place: int,
) -> tuple[np.ndarray, np.ndarray]:
    """The bounds after one more intersection; `last_place` is q in halves of a unit."""
    further = np.zeros_like(allowed)
    denominator = np.ones_like(common)
    for axis in range(3):
        rays = hit & (axes == axis)
        e = magnitude[axis, rays]
        denominator[rays] = e
        for u in OTHER_AXES[axis]:
            carried = allowed[u, rays] * e + magnitude[u, rays] * allowed[axis, rays]
            further[u, rays] = carried + last_place * common[rays] * e
    return further, common * denominator


def _summary(
    off: np.ndarray,
    allowed: np.ndarray,
    common: np.ndarray,
    denominator: np.ndarray,
    hit: np.ndarray,
    flips: int,
    scale: int,
) -> DepthErrors:
    """Errors off / (denominator * scale) against bounds allowed / (common * 2 * scale), of the rays that hit."""
    if not hit.any():
        return DepthErrors(0, flips, 0.0, 0.0, 0.0, 0.0, 0)
    off, allowed, common, denominator = off[:, hit], allowed[:, hit], common[hit], denominator[hit]
    errors = off / (denominator * scale).astype(float)
    bounds = allowed.astype(float) / (common.astype(float) * 2 * scale)
    # Only where the two are next to each other are the products compared themselves, which no machine word holds.
    exceeded = sum(
        int(off[place]) * 2 * int(common[place[1]]) > int(allowed[place]) * int(denominator[place[1]])
        for place in map(tuple, np.argwhere(errors > bounds * (1 - NEAR)))
    )
    bounded = bounds > 0
    return DepthErrors(
        rays=int(hit.sum()),
        flips=flips,
        worst=float(errors.max()),
        mean=float(errors.max(axis=0).mean()),
        bound=float(bounds.max()),
        tightest=float((errors[bounded] / bounds[bounded]).max()) if bounded.any() else 0.0,
        exceeded=exceeded,
    )


def conditions(
    rectangles: Rectangles, camera: Sequence[int], slopes: np.ndarray, perfect: Trace
) -> tuple[np.ndarray, ...]:
    """How far a hit moves for each unit by which a slope is off: the condition number of the intersection.

    A ray hits at P[u] = E[u] + D[u] t with t = n / e and e = D[a]. A change of D[u] moves it by t along u, one of D[a]
    by t |D[u] / e|: the greatest of these. Mirrors do not change it, as t runs on through them.

    Args:
        rectangles: the table.
        camera: where the rays start, in world units.
        slopes: int (rays, 3), none of them all 0.
        perfect: what they meet.

    Returns:
        By depth of reflection, float (rays,): in world units; not a number where nothing is hit.
    """
    magnitude = np.abs(np.asarray(slopes))
    # Along the steepest axis, whose slope is not 0.
    steepest = magnitude.argmax(axis=1)[:, None]
    start = np.take_along_axis(np.broadcast_to(np.asarray(camera, dtype=float), magnitude.shape), steepest, axis=1)
    t = np.zeros(len(magnitude))
    found = []
    for winner, points, denominator in zip(perfect.winners, perfect.points, perfect.denominators, strict=True):
        hit = winner >= 0
        place = np.take_along_axis(points, steepest, axis=1) / np.where(hit, denominator, 1)[:, None]
        t = t + (np.abs(place - start) / np.take_along_axis(magnitude, steepest, axis=1))[:, 0]
        start = place
        across = magnitude.copy()
        across[np.arange(len(winner)), rectangles.axes[winner]] = 0
        found.append(np.where(hit, t * np.maximum(1, across.max(axis=1) / np.where(hit, denominator, 1)), np.nan))
    return tuple(found)
