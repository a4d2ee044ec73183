# SPDX-License-Identifier: MIT
"""Leaf tests of `array_multiplier`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from arithmetic_vectors import factors
from vectors import check, leaf_of

from raycaster.hdl.signals import Signed
from raycaster.rtl.engine.array_multiplier import array_multiplier


@pytest.mark.parametrize(("width", "count", "kept"), [(4, 5, 9), (5, 3, 6), (10, 9, 18), (11, 9, 20)])
def test_array_multiplier(width, count, kept, tmp_path, random):
    """Factors at their limits, with single bits, and random ones."""
    widths = {"multiplicand": Signed(width), "multiplier": Signed(count), "product": Signed(kept)}
    pairs = [(one, other) for one in factors(random, width) for other in factors(random, count)]
    stimulus = [{"multiplicand": one, "multiplier": other} for one, other in pairs]
    expected = [{"product": one * other % (1 << kept)} for one, other in pairs]
    check(leaf_of(array_multiplier, tmp_path, **widths), stimulus, expected)
