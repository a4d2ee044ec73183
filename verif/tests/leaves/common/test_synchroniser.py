# SPDX-License-Identifier: MIT
"""Leaf tests of `synchroniser`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.rtl.common.synchroniser import synchroniser


@pytest.mark.parametrize("resettable", [False, True])
@pytest.mark.parametrize("width", [1, 5])
def test_synchroniser(width, resettable, tmp_path, random):
    leaf = Leaf(synchroniser, lambda: ports(
        "clk", reset=reset_signal() if resettable else None, value=unsigned(width) if width > 1 else bit(),
        held=unsigned(width) if width > 1 else bit()
    ), tmp_path)  # fmt: skip
    stimulus = [{"value": int(random.integers(1 << width))} for _ in range(200)]
    if resettable:
        stimulus = [cycle | {"reset": int(random.random() < 0.1)} for cycle in stimulus]
    for cycle, output in enumerate(leaf.run_both(stimulus, settled=2)):
        if cycle > 1:
            before, last = stimulus[cycle - 2 : cycle]
            expected = 0 if before.get("reset") or last.get("reset") else before["value"]
            assert output == {"held": expected}, cycle
