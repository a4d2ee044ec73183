# SPDX-License-Identifier: MIT
"""Distributions over worlds, and fitted lines with confidence intervals from resampled worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLED, RESAMPLING_SEED, LEVEL = 2000, 1, 95
"""Number of bootstrap samples, drawn from the worlds with replacement; their seed; confidence level, in per cent."""


@dataclass(frozen=True)
class Spread:
    """Summary of a distribution."""

    least: float
    median: float
    mean: float
    most: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Summarise at least one value."""
        return cls(*(float(of(values)) for of in (np.min, np.median, np.mean, np.max)))


@dataclass(frozen=True)
class Slope:
    """Slope of a straight line, with its confidence interval."""

    slope: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.slope:.3g} ({LEVEL}% interval {self.low:.3g} to {self.high:.3g})"


def slope(
    places: Sequence[float], sums: np.ndarray, counts: np.ndarray | None = None, *, binary: bool = False
) -> Slope:
    """Fit a line to the means over all worlds by least squares; its interval comes from a bootstrap over worlds.

    Rays of one world are correlated, so worlds are resampled, not rays. The means at `places` are those of values with
    these sums and counts, (worlds, places); all counts are 1 by default. If binary, logarithms to base 2 are fitted.

    Raises:
        ValueError: a place has no values to average, or a mean is 0 although its logarithm is needed.
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
