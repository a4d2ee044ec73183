# SPDX-License-Identifier: MIT
"""Leaf test of `ones_count`."""

from raycaster.rtl.dvi.ones_count import ones_count


def test_ones_count(leaf_of):
    leaf = leaf_of(ones_count, bits=8, count=4)
    for bits in range(256):
        leaf.case({"bits": bits}, {"count": bits.bit_count()})
    leaf.check()
