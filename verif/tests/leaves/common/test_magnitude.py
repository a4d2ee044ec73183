# SPDX-License-Identifier: MIT
"""Leaf tests of `magnitude`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.common.magnitude import magnitude


@pytest.mark.parametrize(("value_bits", "bits"), [(2, 1), (5, 4), (10, 9), (13, 9)])
def test_magnitude(value_bits, bits, tmp_path):
    """Every value whose magnitude fits."""
    leaf = Leaf(magnitude, lambda: ports("", value=signed(value_bits), result=unsigned(bits)), tmp_path)
    values = range(1 - (1 << bits), 1 << bits)
    outputs = leaf.run_both([{"value": value % (1 << value_bits)} for value in values])
    assert [output["result"] for output in outputs] == [abs(value) for value in values]
