# SPDX-License-Identifier: MIT
"""Leaf tests of `array_multiplier`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from arithmetic_vectors import factors
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed
from raycaster.rtl.engine.array_multiplier import array_multiplier


@pytest.mark.parametrize(("width", "count", "kept"), [(4, 5, 9), (5, 3, 6), (10, 9, 18), (11, 9, 20)])
def test_array_multiplier(width, count, kept, tmp_path, random):
    leaf = Leaf(array_multiplier, lambda: ports(
        "", multiplicand=signed(width), multiplier=signed(count), product=signed(kept)
    ), tmp_path)  # fmt: skip
    stimulus = [
        {"multiplicand": multiplicand, "multiplier": multiplier}
        for multiplicand in factors(random, width)
        for multiplier in factors(random, count)
    ]
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        product = inputs["multiplicand"] * inputs["multiplier"]
        assert outputs == {"product": product % (1 << kept)}, inputs
