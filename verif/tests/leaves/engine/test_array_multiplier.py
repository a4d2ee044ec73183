# SPDX-License-Identifier: MIT
"""Leaf test of `array_multiplier`: factors at their limits, with single bits, and random ones."""

import pytest
from arithmetic_vectors import factors

from raycaster.hdl.signals import Signed
from raycaster.rtl.engine.array_multiplier import array_multiplier


@pytest.mark.parametrize(("width", "count", "kept"), [(4, 5, 9), (5, 3, 6), (10, 9, 18), (11, 9, 20)])
def test_array_multiplier(width, count, kept, leaf_of, random):
    widths = {"multiplicand": Signed(width), "multiplier": Signed(count), "product": Signed(kept)}
    leaf = leaf_of(array_multiplier, **widths)
    for one in factors(random, width):
        for other in factors(random, count):
            leaf.case({"multiplicand": one, "multiplier": other}, {"product": one * other % (1 << kept)})
    leaf.check()
