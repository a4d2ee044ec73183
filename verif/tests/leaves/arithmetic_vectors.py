# SPDX-License-Identifier: MIT
"""Operands for leaf tests of arithmetic, and the weights of a pixel's rays."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from raycaster.configuration import Configuration
from raycaster.design.decide import configure

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


def plain_shares(hits: list[tuple[bool, int]]) -> list[Fraction]:
    """Return the weight of each ray's colour: mirrors pass their quarters on, a miss and the last hit pass nothing."""
    shares, left = [], Fraction(1)
    for number, (found, quarters) in enumerate(hits):
        passed_on = Fraction(quarters, 4) if found and number < len(hits) - 1 else Fraction(0)
        shares.append(left * (1 - passed_on))
        left *= passed_on
    return shares


def cases(random: np.random.Generator, run_time: int, one_ray: list) -> list[tuple]:
    """Combine outcomes of a pixel's rays: all combinations, or a random choice if they are too many."""
    if len(one_ray) ** (run_time + 1) <= 1000:
        return list(product(one_ray, repeat=run_time + 1))
    return [tuple(one_ray[i] for i in random.integers(len(one_ray), size=run_time + 1)) for _ in range(300)]
