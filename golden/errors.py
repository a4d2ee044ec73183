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

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from raycaster.golden import exact, seed_engine
from raycaster.golden.seed_engine import Rounding
from raycaster.golden.world import OTHER_AXES, Rectangles


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


@dataclass(frozen=True)
class Errors:
    """What rounding did to a picture."""

    pixels: int
    wrong: int
    """Pixels whose colour is not the exact one."""

    psnr: float
    """Peak signal-to-noise ratio of the colours in dB, of a peak of 255; infinite where none is wrong."""

    depths: tuple[DepthErrors, ...]
    """By depth of reflection, the primary rays first."""


def compare(
    rectangles: Rectangles,
    camera: Sequence[int],
    background: Sequence[int],
    slopes: np.ndarray,
    reflections: int,
    fraction_bits: int,
    rounding: Rounding,
) -> Errors:
    """Trace rays both ways and compare.

    Args:
        rectangles: the table.
        camera: where the rays start, in world units.
        background: red, green, blue.
        slopes: int (rays, 3), none 0 along x.
        reflections: 0 or more; above 2 the integers become Python's own, which takes a hundred times as long.
        fraction_bits: F.
        rounding: of quotients.
    """
    perfect = exact.trace(rectangles, camera, background, slopes, reflections)
    rounded = seed_engine.trace(
        rectangles, camera, background, slopes, reflections, fraction_bits=fraction_bits, rounding=rounding
    )
    return Errors(
        pixels=len(slopes),
        wrong=int((perfect.colours != rounded.colours).any(axis=1).sum()),
        psnr=_psnr(rounded.colours, perfect.colours),
        depths=depth_errors(rectangles, slopes, perfect, rounded.winners, rounded.points, fraction_bits, rounding),
    )


def depth_errors(
    rectangles: Rectangles,
    slopes: np.ndarray,
    perfect: exact.Trace,
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
        winners: for each depth, int64 (rays,): what they met, as `seed_engine.Trace` has it.
        points: for each depth, int64 (rays, 3): where, in units of 2^-F.
        fraction_bits: F.
        rounding: of quotients.
    """
    # Slopes only change signs, so the magnitudes serve all depths.
    kind = object if len(winners) > 3 else np.int64
    magnitude = np.abs(np.asarray(slopes)).T.astype(kind)
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
        denominator = perfect.denominators[depth].astype(kind)
        # Errors over denominator * scale.
        off = np.abs(points[depth].T.astype(kind) * denominator - perfect.points[depth].T.astype(kind) * scale)
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
    exceeded = int((off * (2 * common) > allowed * denominator).sum())
    errors = off.astype(float) / (denominator * scale).astype(float)
    bounds = allowed.astype(float) / (common * 2 * scale).astype(float)
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


def _psnr(picture: np.ndarray, reference: np.ndarray) -> float:
    error = float(((picture.astype(float) - reference.astype(float)) ** 2).mean())
    return float("inf") if error == 0 else float(10 * np.log10(255**2 / error))
