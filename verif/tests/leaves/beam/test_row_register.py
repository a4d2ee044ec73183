# SPDX-License-Identifier: MIT
"""Leaf test of `row_register`: any live bits are kept, and the others have their known values."""

from vectors import by

from raycaster.rtl.beam.row_register import row_register


@by(live=[0xFFF, 0x5C3, 0])
def test_row_register(live, leaf_of, random):
    leaf = leaf_of(row_register, **dict.fromkeys(("given", "live", "known", "word"), 12))
    kept = None
    for load in [1, *(random.random(200) < 0.3)]:
        given, other, known = (int(bits) for bits in random.integers(1 << 12, size=3))
        now = live if random.random() < 0.5 else other
        word = None if kept is None else kept & now | known & ~now
        leaf.case({"load": load, "given": given, "live": now, "known": known & ~now}, {"word": word})
        if load:
            kept = given
    leaf.check(settled=1)
