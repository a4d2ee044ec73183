# SPDX-License-Identifier: MIT
"""Leaf test of `divider`: divisions back to back: each load comes with the store of the previous division."""

import numpy as np
import pytest
from arithmetic_vectors import SLOPE_CORNERS, VECTORS, arithmetic, position_corners

from raycaster.configuration import Configuration
from raycaster.golden import seed_engine
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits, product_bits
from raycaster.rtl.seed.divider import divider


def dividends_and_divisors(config: Configuration, random: np.random.Generator) -> list[tuple[int, int]]:
    """Return corner cases and random operands; quotients sensitive to rounding or overflow are common."""
    limit = 1 << position_bits(config)
    operands = [(n * d, e) for n in position_corners(config) for d in SLOPE_CORNERS for e in SLOPE_CORNERS if n < limit]
    chosen = [operands[index] for index in random.permutation(len(operands))[: VECTORS // 2]]
    for _ in range(VECTORS):
        divisor = int(random.integers(1, 1 << SLOPE_BITS))
        quotient = int(random.choice([0, 1, limit - 2, limit - 1, limit, random.integers(limit)]))
        remainder = int(random.choice([0, divisor // 2, (divisor + 1) // 2, divisor - 1]))
        chosen.append((min(quotient * divisor + remainder, (1 << product_bits(config)) - 1), divisor))
    return chosen


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_divider(config, leaf_of, random):
    widths = {"dividend": product_bits(config), "divisor": SLOPE_BITS, "quotient": position_bits(config)}
    leaf, steps = leaf_of(divider, config, **widths), config.divider_steps
    for dividend, divisor in dividends_and_divisors(config, random):
        load = {"load_divider": 1, "store_quotient": bool(leaf.stimulus), "dividend": dividend, "divisor": divisor}
        leaf.stimulus += [load, *[dict.fromkeys(load, 0)] * (steps - 1)]
        quotient, overflow = seed_engine.divide(dividend, divisor, config.fraction_bits, config.rounding)
        leaf.expected[leaf.cycle + 1] = {"overflow": overflow, "quotient": None if overflow else quotient}
    leaf.stimulus += [{"load_divider": 0, "store_quotient": 1}, {"store_quotient": 0}]
    leaf.check(settled=steps + 1)
