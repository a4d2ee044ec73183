# SPDX-License-Identifier: MIT
"""Leaf tests of `divider`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from arithmetic_vectors import SLOPE_CORNERS, VECTORS, arithmetic, position_corners
from vectors import ports

from raycaster.configuration import Configuration
from raycaster.golden import seed_engine
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
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
def test_divider(config, tmp_path, random):
    leaf = Leaf(divider, lambda: ports(
        "clk load_divider store_quotient overflow", dividend=unsigned(product_bits(config)),
        divisor=unsigned(SLOPE_BITS), quotient=unsigned(position_bits(config)), config=config
    ), tmp_path)  # fmt: skip
    operands = dividends_and_divisors(config, random)
    steps = config.divider_steps
    stimulus = []
    for number, (dividend, divisor) in enumerate(operands):
        # Back to back: each load comes with the store of the previous division.
        stimulus.append(
            {"load_divider": 1, "store_quotient": int(number > 0), "dividend": dividend, "divisor": divisor}
        )
        stimulus += [{"load_divider": 0, "store_quotient": 0, "dividend": 0, "divisor": 0}] * (steps - 1)
    stimulus += [{"load_divider": 0, "store_quotient": 1}, {"store_quotient": 0}]
    outputs = leaf.run_both(stimulus, settled=steps + 1)
    for number, (dividend, divisor) in enumerate(operands):
        quotient, overflow = seed_engine.divide(dividend, divisor, config.fraction_bits, config.rounding)
        result = outputs[(number + 1) * steps + 1]
        assert bool(result["overflow"]) == bool(overflow), (dividend, divisor)
        if not overflow:
            assert result["quotient"] == quotient, (dividend, divisor)
