# SPDX-License-Identifier: MIT
"""Leaf tests of `multiplier_step`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from arithmetic_vectors import factors
from vectors import check, leaf_of

from raycaster.hdl.signals import Signed
from raycaster.rtl.engine.multiplier_step import multiplier_step


@pytest.mark.parametrize("subtract", [False, True])
@pytest.mark.parametrize(("width", "count"), [(3, 3), (4, 2), (11, 9)])
def test_multiplier_step(width, count, subtract, tmp_path, random):
    """One bit of the multiplier; the lowest bit of the sum becomes the highest digit."""
    widths = dict.fromkeys(("multiplicand", "total", "next_total"), Signed(width))
    leaf = leaf_of(multiplier_step, tmp_path, **widths, digits=count, next_digits=count, subtract=subtract)
    stimulus, expected = [], []
    for multiplicand in factors(random, width):
        for total in factors(random, width):
            for digits in {0, (1 << count) - 1, 1, int(random.integers(1 << count))}:
                stimulus.append({"multiplicand": multiplicand, "total": total, "digits": digits})
                others, digit = divmod(digits, 2)
                added = total + (-digit if subtract else digit) * multiplicand
                expected.append({"next_total": added >> 1, "next_digits": (added & 1) << count - 1 | others})
    check(leaf, stimulus, expected)
