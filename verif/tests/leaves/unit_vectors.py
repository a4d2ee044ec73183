# SPDX-License-Identifier: MIT
"""Vectors for leaf tests of the parts of a ray unit."""

from fractions import Fraction
from itertools import product

import numpy as np
from vectors import any_config

from raycaster.configuration import Configuration


def unit_config(**options) -> Configuration:
    """Make a design with few rectangles."""
    return any_config(**{"rectangles": 4} | options)


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
