# SPDX-License-Identifier: MIT
"""Golden model of the seed engine, bit for bit as its hardware computes, with a division per rectangle.

Origins, planes and hit points are fixed-point numbers with F fraction bits: integers in units of 2^-F. Each coordinate
of a hit point costs one division of magnitudes. Its quotient is rounded, and reflected rays start at the rounded point:
that is the engine's only error.

Widths: |n| < 2^(9 + F) and |slope| is at most 190 for primary rays of all screens, so dividends stay below 2^(17 + F),
and within 2^25 at F = 8. Arrays are int64, so nothing overflows before slopes of 2^40.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from raycaster.configuration import COORDINATE_BITS, Rounding
from raycaster.golden.model import Bounce, Meeting, Model
from raycaster.golden.world import OTHER_AXES, Rectangles


@dataclass(frozen=True)
class SeedModel(Model):
    """Golden model of the seed engine, which measures depth along x, so its camera cannot turn."""

    fraction_bits: int = 0
    """F, 0..8."""

    rounding: Rounding = "truncate"
    """Rounding of quotients."""

    features: Collection[str] = field(default=("materials", "patterns"), kw_only=True)

    def bound(self, origin: np.ndarray, slope: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Bound the error of a primary ray's hit point, in world units: one unit in the last place, or half of one."""
        return np.full(way.shape, (1 if self.rounding == "truncate" else 0.5) / (1 << self.fraction_bits))

    def meetings(
        self, rectangles: Rectangles, origin: np.ndarray, slope: np.ndarray, *, keep: bool
    ) -> Iterator[Meeting]:
        """Follow rays from one rounded hit point to the next."""
        origin = origin << self.fraction_bits
        met = np.ones(slope.shape, dtype=bool)
        alive = met[0].copy()
        scale = np.full(len(alive), 1 << self.fraction_bits)
        while True:
            bounce = Bounce.empty(len(rectangles), origin, slope, met, alive) if keep else None
            winner, origin = self._nearest(rectangles, origin, slope, alive, bounce=bounce)
            yield Meeting(winner, origin.T, scale, slope.T.copy(), bounce)
            alive = (winner >= 0) & (rectangles.mirrors[winner] > 0)
            for axis in range(3):
                slope[axis, alive & (rectangles.axes[winner] == axis)] *= -1

    def _nearest(
        self,
        rectangles: Rectangles,
        origin: np.ndarray,
        slope: np.ndarray,
        alive: np.ndarray,
        *,
        bounce: Bounce | None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Find the nearest rectangle and the point where it is hit; arrays are ([3,] rays).

        For a miss, and for a ray that is not alive, they are -1 and the origin.
        """
        fraction_bits = self.fraction_bits
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
                point[u], valid = intersect(
                    origin[u], slope[u], plane, origin[axis], slope[axis], fraction_bits, self.rounding
                )
                hit &= valid & (low[u] <= point[u]) & (point[u] <= high[u])
                validities.append(valid)
            depth = np.abs(point[0] - origin[0])
            # Strict, so the lower index wins a tie.
            nearer = hit & (depth < best_depth)
            winner[nearer] = index
            np.copyto(best_depth, depth, where=nearer)
            np.copyto(best_point, point, where=nearer)
            if bounce:
                valid = np.transpose(validities)
                bounce.note(
                    index, numerators=plane - origin[axis], denominators=slope[axis], scales=1 << fraction_bits,
                    quotients=np.abs(point - origin)[list(OTHER_AXES[axis])].T * valid, valid=valid, points=point.T,
                    depths=depth, hits=hit,
                )  # fmt: skip
        return winner, best_point


def divide(
    numerator: ArrayLike, denominator: ArrayLike, fraction_bits: int = 0, rounding: Rounding = "truncate"
) -> tuple[np.ndarray, np.ndarray]:
    """Divide magnitudes like the hardware's divider.

    Args:
        numerator: int, 0 or more; it already includes the quotient's fraction bits, so it is not shifted here.
        denominator: int, 0 or more.
        fraction_bits: F; the quotient has 9 + F bits.
        rounding: toward zero, or to nearest with halves up.

    Returns:
        The quotient, int64, and the overflow, bool: denominator 0, or a rounded quotient of more than 9 + F bits.
        The quotient is 0 where it overflows. Both have the arguments' common shape.

    Raises:
        ValueError: there is no such rounding.
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
    """Compute one coordinate of a hit point: a + b (c - d) / e.

    Args:
        a: the origin on this axis, in units of 2^-F.
        b: the slope on this axis, in world units.
        c: the rectangle's plane, in units of 2^-F.
        d: the origin on the plane's axis, in units of 2^-F.
        e: the slope on the plane's axis, in world units.
        fraction_bits: F.
        rounding: rounding of the quotient.

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
