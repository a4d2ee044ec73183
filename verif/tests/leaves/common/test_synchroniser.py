# SPDX-License-Identifier: MIT
"""Leaf test of `synchroniser`."""

from itertools import pairwise

from vectors import by

from raycaster.hdl.signals import reset_signal
from raycaster.rtl.common.synchroniser import synchroniser


@by(width=[1, 5], resettable=[False, True])
def test_synchroniser(width, resettable, leaf_of, random):
    widths = {"value": width, "held": width} if width > 1 else {}
    leaf = leaf_of(synchroniser, reset=reset_signal if resettable else lambda: None, **widths)
    leaf.stimulus = [{"value": int(random.integers(1 << width))} for _ in range(200)]
    if resettable:
        leaf.stimulus = [cycle | {"reset": int(random.random() < 0.1)} for cycle in leaf.stimulus]
    for cycle, (before, last) in enumerate(pairwise(leaf.stimulus)):
        leaf.expected[cycle]["held"] = 0 if before.get("reset") or last.get("reset") else before["value"]
    leaf.check(latency=2)
