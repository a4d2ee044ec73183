# SPDX-License-Identifier: MIT
"""Errors of the seed engine's rounding against the exact picture, ray by ray, and their bounds.

An intersection forms P[u] = O[u] + D[u] (k - O[a]) / e. The plane k is exact, so an origin that is off by d[u] and d[a]
puts the point off by at most

    d'[u] = d[u] + |D[u] / e| d[a] + q,    d'[a] = 0,

where q is the error of the quotient's rounding: one unit in the last place for truncation, half of one for nearest. The
primary ray starts from d = 0. This is standard forward error analysis (Higham 2002, chapter 1). It holds for a ray as
long as it hits the same rectangles as the exact ray; a ray that does not has flipped, and is only counted.

All comparisons are of integers: distances over a common denominator, the product of all slopes so far and of 2^(F + 1),
which covers the half.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from raycaster.configuration import Rounding
from raycaster.golden.model import Trace
from raycaster.golden.world import OTHER_AXES, Rectangles

NEAR = 1e-9
"""Relative margin for comparing two floating-point quotients, far above their rounding errors."""


@dataclass(frozen=True)
class DepthErrors:
    """Errors at one depth of reflection, 0 for primary rays, of the rays that have not flipped before."""

    rays: int
    """Number of rays that hit the same rectangle as the exact ray."""

    flips: int
    """Number of rays that hit something else, or nothing, or something although the exact ray hits nothing."""

    worst: float
    """Greatest error of a coordinate of a hit point, in world units; 0 if no ray hit."""

    mean: float
    """Mean, over the rays, of a ray's greatest error of a coordinate, in world units; 0 if no ray hit."""

    bound: float
    """Greatest bound on an error of the rays, in world units."""

    tightest: float
    """Greatest ratio of a coordinate's error to its bound; more than 1 would be wrong."""

    exceeded: int
    """Number of coordinates whose error exceeds their bound."""


def condition(slopes: np.ndarray, perfect: Trace) -> float | None:
    """Return a picture's greatest relative condition number, 1 or more, or None if no ray hits.

    It is the relative change of a hit point per relative change of the slope D, for small changes. In P = E + D n / e,
    a change of D moves P within the plane by (n / e) (I - D e_a^T / e) times the change. That matrix projects along D,
    so its norm is |D| / |e|, and so is the condition number, relative to |P - E| = |D| n / e: one over the cosine of
    the angle of incidence. Mirrors do not change it, as they change only signs.

    Args:
        slopes: int (rays, 3): slopes of the rays.
        perfect: exact trace of the rays.
    """
    length = np.sqrt((np.asarray(slopes, dtype=float) ** 2).sum(axis=1))
    hits = zip(perfect.winners, perfect.denominators, strict=True)
    found = np.concatenate([length[winner >= 0] / e[winner >= 0] for winner, e in hits])
    return float(found.max()) if len(found) else None


def depth_errors(
    rectangles: Rectangles,
    slopes: np.ndarray,
    perfect: Trace,
    winners: Sequence[np.ndarray],
    points: Sequence[np.ndarray],
    fraction_bits: int,
    rounding: Rounding,
) -> tuple[DepthErrors, ...]:
    """Compare hit points of the seed engine with the exact ones, and the errors with their bounds.

    Args:
        rectangles: the table.
        slopes: int (rays, 3): slopes of the primary rays.
        perfect: exact trace of the rays.
        winners: for each depth, int64 (rays,): the rectangles that they hit, as in `Trace`.
        points: for each depth, int64 (rays, 3): the hit points, in units of 2^-F.
        fraction_bits: F.
        rounding: rounding of quotients.

    Returns:
        The errors by depth of reflection, the primary rays first.
    """
    # Slopes only change signs, so the magnitudes serve all depths.
    magnitude = np.abs(np.asarray(slopes)).T
    # At each depth, a bound's numerator is multiplied by at most twice a slope; it starts at 4.
    if len(winners) * math.log2(2 * magnitude.max()) + 2 >= 63:
        # Python's own integers do not overflow, but take a hundred times as long.
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
        # A ray that hits nothing has ended, and is not compared any further.
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
    """Return the bounds after one more intersection; `last_place` is q in halves of a unit."""
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
    """Compare errors off / (denominator * scale) with bounds allowed / (common * 2 * scale), for the rays that hit."""
    if not hit.any():
        return DepthErrors(0, flips, 0.0, 0.0, 0.0, 0.0, 0)
    off, allowed, common, denominator = off[:, hit], allowed[:, hit], common[hit], denominator[hit]
    errors = off / (denominator * scale).astype(float)
    bounds = allowed.astype(float) / (common.astype(float) * 2 * scale)
    # Only if the two are close are the exact products compared, which exceed a machine word.
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
