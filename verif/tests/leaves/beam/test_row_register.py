# SPDX-License-Identifier: MIT
"""Leaf tests of `row_register`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import check, leaf_of

from raycaster.rtl.beam.row_register import row_register


@pytest.mark.parametrize("live", [0xFFF, 0x5C3, 0])
def test_row_register(live, tmp_path, random):
    """Any live bits are kept, and the others have their known values."""
    leaf = leaf_of(row_register, tmp_path, **dict.fromkeys(("given", "live", "known", "word"), 12))
    stimulus, expected, kept = [], [], None
    for load in [1, *(random.random(200) < 0.3)]:
        given, other, known = (int(bits) for bits in random.integers(1 << 12, size=3))
        now = live if random.random() < 0.5 else other
        stimulus.append({"load": load, "given": given, "live": now, "known": known & ~now})
        expected.append(None if kept is None else {"word": kept & now | known & ~now})
        if load:
            kept = given
    check(leaf, stimulus, expected, settled=1)
