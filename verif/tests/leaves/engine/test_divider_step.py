# SPDX-License-Identifier: MIT
"""Leaf tests of `divider_step`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from arithmetic_vectors import SLOPE_CORNERS
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.engine.divider_step import divider_step


@pytest.mark.parametrize(("width", "count"), [(1, 2), (2, 3), (4, 4), (9, 9), (9, 17)])
def test_divider_step(width, count, tmp_path, random):
    leaf = Leaf(divider_step, lambda: ports(
        "", remainder=unsigned(width), digits=unsigned(count), divisor=unsigned(width),
        next_remainder=unsigned(width), next_digits=unsigned(count)
    ), tmp_path)  # fmt: skip
    divisors = range(1, 1 << width) if width < 9 else SLOPE_CORNERS[1:]
    stimulus = [
        {"remainder": remainder, "digits": digits, "divisor": divisor}
        for divisor in divisors
        for remainder in (range(divisor) if width < 9 else {0, divisor // 2, divisor - 1})
        for digits in {0, (1 << count) - 1, 1 << count - 1, int(random.integers(1 << count))}
    ]
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        digit, others = divmod(inputs["digits"], 1 << count - 1)
        quotient, remainder = divmod(2 * inputs["remainder"] + digit, inputs["divisor"])
        assert outputs == {"next_remainder": remainder, "next_digits": 2 * others + quotient}, inputs
