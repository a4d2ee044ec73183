# SPDX-License-Identifier: MIT
"""Leaf test of `divider_step`: one bit of the quotient, for every divisor or those at the limits."""

import pytest
from arithmetic_vectors import SLOPE_CORNERS

from raycaster.rtl.engine.divider_step import divider_step


@pytest.mark.parametrize(("width", "count"), [(1, 2), (2, 3), (4, 4), (9, 9), (9, 17)])
def test_divider_step(width, count, leaf_of, random):
    widths = dict.fromkeys(("remainder", "divisor", "next_remainder"), width)
    leaf = leaf_of(divider_step, **widths, digits=count, next_digits=count)
    for divisor in range(1, 1 << width) if width < 9 else SLOPE_CORNERS[1:]:
        for remainder in range(divisor) if width < 9 else {0, divisor // 2, divisor - 1}:
            for digits in {0, (1 << count) - 1, 1 << count - 1, int(random.integers(1 << count))}:
                leaf.case({"remainder": remainder, "digits": digits, "divisor": divisor})
                digit, others = divmod(digits, 1 << count - 1)
                quotient, left = divmod(2 * remainder + digit, divisor)
                leaf.expect({"next_remainder": left, "next_digits": 2 * others + quotient})
    leaf.check()
