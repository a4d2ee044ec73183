# SPDX-License-Identifier: MIT
"""Leaf tests of `synchroniser`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import pairwise

import pytest
from vectors import check, leaf_of

from raycaster.hdl.signals import reset_signal
from raycaster.rtl.common.synchroniser import synchroniser


@pytest.mark.parametrize("resettable", [False, True])
@pytest.mark.parametrize("width", [1, 5])
def test_synchroniser(width, resettable, tmp_path, random):
    widths = {"value": width, "held": width} if width > 1 else {}
    leaf = leaf_of(synchroniser, tmp_path, reset=reset_signal if resettable else lambda: None, **widths)
    stimulus = [{"value": int(random.integers(1 << width))} for _ in range(200)]
    if resettable:
        stimulus = [cycle | {"reset": int(random.random() < 0.1)} for cycle in stimulus]
    pairs = pairwise(stimulus)
    held = [0 if before.get("reset") or last.get("reset") else before["value"] for before, last in pairs]
    check(leaf, stimulus, [{"held": value} for value in held], latency=2)
