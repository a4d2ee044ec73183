# SPDX-License-Identifier: MIT
"""Operands for leaf tests of arithmetic."""

import numpy as np
import pytest

from raycaster.configuration import Configuration, configure

VECTORS = 300

SLOPE_CORNERS = (0, 1, 2, 100, 160, 190, 255, 256, 510, 511)

arithmetic = pytest.mark.parametrize(
    "config",
    [
        configure(fraction_bits=bits, rounding=rounding, divider_bits=divider_bits, allow_underrun=True)
        for bits in (0, 1, 4, 8)
        for rounding in ("truncate", "nearest")
        for divider_bits in (1, 2, 3)
    ],
    ids=lambda config: f"F{config.fraction_bits}-{config.rounding}-{config.divider_bits}bits",
)


def position_corners(config: Configuration) -> list[int]:
    one = 1 << config.fraction_bits
    whole = [0, 1, 2, 255, 256, 510, 511]
    return sorted({value * one for value in whole} | {value * one + one - 1 for value in whole} | {1, one})


def factors(random: np.random.Generator, width: int) -> list[int]:
    """Return all factors if they are few, otherwise those where digits or signs change and some at random."""
    least, most = -(1 << width - 1), (1 << width - 1) - 1
    if width < 6:
        return list(range(least, most + 1))
    powers = {sign * (1 << place) + more for place in range(width - 1) for sign in (1, -1) for more in (-1, 0)}
    return sorted(powers | {least, most} | {int(value) for value in random.integers(least, most, size=8)})
