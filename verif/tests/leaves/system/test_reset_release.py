# SPDX-License-Identifier: MIT
"""Leaf tests of `reset_release`: MyHDL and converted Verilog match the expected values on the same vectors."""

from vectors import check, leaf_of

from raycaster.hdl.signals import bit
from raycaster.rtl.system.reset_release import reset_release

HOLD_CYCLES = 16
"""Cycles for which reset continues after its cause is over."""


def test_reset_release(tmp_path, random):
    """Interruptions of a reset just before and just after its end."""
    ready = [0] * 4
    for _ in range(30):
        length = int(random.choice([1, 2, HOLD_CYCLES - 1, HOLD_CYCLES, HOLD_CYCLES + 1, 2 * HOLD_CYCLES]))
        ready += [1] * length + [0] * int(random.integers(1, 4))
    # ready takes two cycles to arrive, and one to be counted.
    windows = [ready[max(0, cycle - HOLD_CYCLES - 2) : max(0, cycle - 2)] for cycle in range(len(ready))]
    expected = [{"reset": not (all(window) and len(window) == HOLD_CYCLES)} for window in windows]
    check(leaf_of(reset_release, tmp_path, reset=bit), [{"ready": value} for value in ready], expected, settled=4)
