# SPDX-License-Identifier: MIT
"""Leaf tests of `ones_count`: MyHDL and converted Verilog match the expected values on the same vectors."""

from vectors import check, leaf_of

from raycaster.rtl.dvi.ones_count import ones_count


def test_ones_count(tmp_path):
    leaf = leaf_of(ones_count, tmp_path, bits=8, count=4)
    check(leaf, [{"bits": bits} for bits in range(256)], [{"count": bits.bit_count()} for bits in range(256)])
