# SPDX-License-Identifier: MIT
"""Distributions over worlds, and lines through them with the interval that other worlds might have given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLED = 2000
"""Times that worlds are drawn again, with replacement."""

RESAMPLING_SEED = 1
LEVEL = 95
"""Per cent of them that an interval holds."""


@dataclass(frozen=True)
class Spread:
    """A distribution in short."""

    least: float
    median: float
    mean: float
    most: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Of at least one value."""
        return cls(*(float(of(values)) for of in (np.min, np.median, np.mean, np.max)))


@dataclass(frozen=True)
class Slope:
    """A straight line's, with the interval."""

    slope: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.slope:.3g} ({LEVEL}% interval {self.low:.3g} to {self.high:.3g})"


def slope(
    places: Sequence[float], sums: np.ndarray, counts: np.ndarray | None = None, *, binary: bool = False
) -> Slope:
    """The line through the means of all worlds, by least squares; its interval by bootstrap over worlds.

    Rays of one world are alike, so worlds are drawn again, not rays.

    Args:
        places: where, one a column.
        sums: float (worlds, places): of what is averaged.
        counts: likewise, of how many; None for one each.
        binary: of the means' logarithms to base 2.

    Raises:
        ValueError: a place has nothing to average, or a logarithm of nothing is asked for.
    """
    sums = np.asarray(sums, dtype=float)
    counts = np.ones_like(sums) if counts is None else np.asarray(counts, dtype=float)

    def lines(total: np.ndarray, number: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            means = total / number
            means = np.log2(means) if binary else means
        off = np.asarray(places, dtype=float) - np.mean(places)
        return means @ off / (off @ off)

    drawn = np.random.default_rng(RESAMPLING_SEED).integers(len(sums), size=(RESAMPLED, len(sums)))
    found = float(lines(sums.sum(axis=0), counts.sum(axis=0)))
    if not np.isfinite(found):
        raise ValueError(f"no line through the means at {list(places)}")
    others = lines(sums[drawn].sum(axis=1), counts[drawn].sum(axis=1))
    low, high = np.percentile(others[np.isfinite(others)], [(100 - LEVEL) / 2, (100 + LEVEL) / 2])
    return Slope(found, float(low), float(high))
