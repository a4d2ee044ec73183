# SPDX-License-Identifier: MIT
"""Leaf tests of `reset_release`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.rtl.system.reset_release import reset_release

HOLD_CYCLES = 16
"""Cycles for which reset continues after its cause is over."""


def test_reset_release(tmp_path, random):
    leaf = Leaf(reset_release, lambda: ports("clk ready reset"), tmp_path)
    ready = [0] * 4
    for _ in range(30):
        length = int(random.choice([1, 2, HOLD_CYCLES - 1, HOLD_CYCLES, HOLD_CYCLES + 1, 2 * HOLD_CYCLES]))
        ready += [1] * length + [0] * int(random.integers(1, 4))
    outputs = leaf.run_both([{"ready": value} for value in ready], settled=4)
    for cycle in range(4, len(ready)):
        # ready takes two cycles to arrive, and one to be counted.
        window = ready[max(0, cycle - HOLD_CYCLES - 2) : cycle - 2]
        expected = int(not (all(window) and len(window) == HOLD_CYCLES))
        assert outputs[cycle] == {"reset": expected}, cycle
