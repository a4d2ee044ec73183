# SPDX-License-Identifier: MIT
"""Leaf test of `reset_release`: interruptions of a reset just before and just after its end."""

from raycaster.hdl.signals import bit
from raycaster.rtl.system.reset_release import reset_release

HOLD_CYCLES = 16
"""Cycles for which reset continues after its cause is over."""


def test_reset_release(leaf_of, random):
    ready = [0] * 4
    for _ in range(30):
        length = int(random.choice([1, 2, HOLD_CYCLES - 1, HOLD_CYCLES, HOLD_CYCLES + 1, 2 * HOLD_CYCLES]))
        ready += [1] * length + [0] * int(random.integers(1, 4))
    leaf = leaf_of(reset_release, reset=bit)
    for cycle, value in enumerate(ready):
        # ready takes two cycles to arrive, and one to be counted.
        window = ready[max(0, cycle - HOLD_CYCLES - 2) : max(0, cycle - 2)]
        leaf.case({"ready": value}, {"reset": not (all(window) and len(window) == HOLD_CYCLES)})
    leaf.check(settled=4)


def test_power_up_resets(leaf_of):
    """Without a low ready, reset lasts as long as it does after one, because the registers begin at 0."""
    leaf = leaf_of(reset_release, reset=bit)
    for cycle in range(3 * HOLD_CYCLES):
        leaf.case({"ready": 1}, {"reset": cycle < HOLD_CYCLES + 2})
    leaf.check()
