# SPDX-License-Identifier: MIT
"""Leaf tests of `magnitude`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import check, leaf_of

from raycaster.hdl.signals import Signed
from raycaster.rtl.common.magnitude import magnitude


@pytest.mark.parametrize(("value_bits", "bits"), [(2, 1), (5, 4), (10, 9), (13, 9)])
def test_magnitude(value_bits, bits, tmp_path):
    """Every value whose magnitude fits."""
    values = range(1 - (1 << bits), 1 << bits)
    leaf = leaf_of(magnitude, tmp_path, value=Signed(value_bits), result=bits)
    check(leaf, [{"value": value} for value in values], [{"result": abs(value)} for value in values])
