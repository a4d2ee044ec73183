# SPDX-License-Identifier: MIT
"""Leaf tests of `multiplier_step`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from arithmetic_vectors import factors
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.engine.multiplier_step import multiplier_step


@pytest.mark.parametrize("subtract", [False, True])
@pytest.mark.parametrize(("width", "count"), [(3, 3), (4, 2), (11, 9)])
def test_multiplier_step(width, count, subtract, tmp_path, random):
    leaf = Leaf(multiplier_step, lambda: ports(
        "", multiplicand=signed(width), total=signed(width), digits=unsigned(count), next_total=signed(width),
        next_digits=unsigned(count), subtract=subtract
    ), tmp_path)  # fmt: skip
    stimulus = [
        {"multiplicand": multiplicand, "total": total, "digits": digits}
        for multiplicand in factors(random, width)
        for total in factors(random, width)
        for digits in {0, (1 << count) - 1, 1, int(random.integers(1 << count))}
    ]
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        others, digit = divmod(inputs["digits"], 2)
        added = inputs["total"] + (-digit if subtract else digit) * inputs["multiplicand"]
        total, digits = added >> 1, (added & 1) << count - 1 | others
        assert outputs == {"next_total": total % (1 << width), "next_digits": digits}, inputs
