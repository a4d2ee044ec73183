# SPDX-License-Identifier: MIT
"""Leaf tests of `bound_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed
from raycaster.rtl.beam.bound_tester import bound_tester


@pytest.mark.parametrize("spare", [0, 2])
def test_bound_tester(spare, tmp_path, random):
    """Ways at and next to a bound, for rays in either direction; a way may have more bits than the bounds."""
    bits = 12
    leaf = Leaf(bound_tester, lambda: ports(
        "clk step back between", way=signed(bits + spare), low=signed(bits), high=signed(bits)
    ), tmp_path)  # fmt: skip
    most, stimulus, expected = (1 << bits - 1) - 1, [], [None]
    for number in range(3000):
        low, high = (int(random.choice([-most - 1, -1, 0, most, random.integers(-most, most)])) for _ in range(2))
        way = int(random.choice([low, high])) + int(random.integers(-1, 2))
        way = int(random.choice([way, random.integers(-most << spare, most << spare)]))
        way = int(np.clip(way, -(most + 1) << spare, most << spare))
        step, back = int(number == 0 or random.random() < 0.8), int(random.integers(2))
        words = {"way": way % (1 << bits + spare), "low": low % (1 << bits), "high": high % (1 << bits)}
        stimulus.append({"step": step, "back": back} | words)
        between = high <= way <= low if back else low <= way <= high
        expected.append(between if step else expected[-1])
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for cycle, wanted in enumerate(expected):
        assert wanted is None or bool(outputs[cycle]["between"]) == wanted, stimulus[cycle - 1]
