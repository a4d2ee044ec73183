# SPDX-License-Identifier: MIT
"""Leaf tests of `bound_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from vectors import check, leaf_of

from raycaster.hdl.signals import Signed
from raycaster.rtl.beam.bound_tester import bound_tester


@pytest.mark.parametrize("spare", [0, 2])
def test_bound_tester(spare, tmp_path, random):
    """Ways at and next to a bound, for rays in either direction; a way may have more bits than the bounds."""
    bits = 12
    leaf = leaf_of(bound_tester, tmp_path, way=Signed(bits + spare), low=Signed(bits), high=Signed(bits))
    most, stimulus, expected = (1 << bits - 1) - 1, [], []
    for number in range(3000):
        low, high = (int(random.choice([-most - 1, -1, 0, most, random.integers(-most, most)])) for _ in range(2))
        way = int(random.choice([low, high])) + int(random.integers(-1, 2))
        way = int(random.choice([way, random.integers(-most << spare, most << spare)]))
        way = int(np.clip(way, -(most + 1) << spare, most << spare))
        step, back = int(number == 0 or random.random() < 0.8), int(random.integers(2))
        stimulus.append({"step": step, "back": back, "way": way, "low": low, "high": high})
        between = high <= way <= low if back else low <= way <= high
        expected.append({"between": between} if step else expected[-1])
    check(leaf, stimulus, expected, latency=1)
