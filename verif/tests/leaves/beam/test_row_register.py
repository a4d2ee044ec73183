# SPDX-License-Identifier: MIT
"""Leaf tests of `row_register`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.row_register import row_register


@pytest.mark.parametrize("live", [0xFFF, 0x5C3, 0])
def test_row_register(live, tmp_path, random):
    """Any live bits are kept, and the others have their known values."""
    leaf = Leaf(row_register, lambda: ports(
        "clk load", given=unsigned(12), live=unsigned(12), known=unsigned(12), word=unsigned(12)
    ), tmp_path)  # fmt: skip
    stimulus = []
    for load in [1, *(random.random(200) < 0.3)]:
        given, other, known = (int(bits) for bits in random.integers(1 << 12, size=3))
        now = live if random.random() < 0.5 else other
        stimulus.append({"load": int(load), "given": given, "live": now, "known": known & ~now})
    kept = None
    for inputs, output in zip(stimulus, leaf.run_both(stimulus, settled=1), strict=True):
        if kept is not None:
            assert output["word"] == kept & inputs["live"] | inputs["known"]
        if inputs["load"]:
            kept = inputs["given"]
