# SPDX-License-Identifier: MIT
"""Leaf tests of `ones_count`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.dvi.ones_count import ones_count


def test_ones_count(tmp_path):
    leaf = Leaf(ones_count, lambda: {"bits": unsigned(8), "count": unsigned(4)}, tmp_path)
    outputs = leaf.run_both([{"bits": bits} for bits in range(256)])
    assert [output["count"] for output in outputs] == [bits.bit_count() for bits in range(256)]
