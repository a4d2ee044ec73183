# SPDX-License-Identifier: MIT
"""Leaf test of `magnitude`: every value whose magnitude fits."""

import pytest

from raycaster.hdl.signals import Signed
from raycaster.rtl.common.magnitude import magnitude


@pytest.mark.parametrize(("value_bits", "bits"), [(2, 1), (5, 4), (10, 9), (13, 9)])
def test_magnitude(value_bits, bits, leaf_of):
    leaf = leaf_of(magnitude, value=Signed(value_bits), result=bits)
    for value in range(1 - (1 << bits), 1 << bits):
        leaf.case({"value": value}, {"result": abs(value)})
    leaf.check()
