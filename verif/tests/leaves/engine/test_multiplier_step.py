# SPDX-License-Identifier: MIT
"""Leaf test of `multiplier_step`: one bit of the multiplier; the lowest bit of the sum becomes the highest digit."""

import pytest
from arithmetic_vectors import factors

from raycaster.hdl.signals import Signed
from raycaster.rtl.engine.multiplier_step import multiplier_step


@pytest.mark.parametrize("subtract", [False, True])
@pytest.mark.parametrize(("width", "count"), [(3, 3), (4, 2), (11, 9)])
def test_multiplier_step(width, count, subtract, leaf_of, random):
    widths = dict.fromkeys(("multiplicand", "total", "next_total"), Signed(width))
    leaf = leaf_of(multiplier_step, **widths, digits=count, next_digits=count, subtract=subtract)
    for multiplicand in factors(random, width):
        for total in factors(random, width):
            for digits in {0, (1 << count) - 1, 1, int(random.integers(1 << count))}:
                leaf.case({"multiplicand": multiplicand, "total": total, "digits": digits})
                others, digit = divmod(digits, 2)
                added = total + (-digit if subtract else digit) * multiplicand
                leaf.expect({"next_total": added >> 1, "next_digits": (added & 1) << count - 1 | others})
    leaf.check()
