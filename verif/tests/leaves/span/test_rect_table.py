# SPDX-License-Identifier: MIT
"""Leaf test of `rect_table`: rectangles that are stored and fetched in any order, also in the same cycle."""

import pytest
from span_vectors import span_config

from raycaster.rtl.common.interfaces import Rects
from raycaster.rtl.common.records import Rect
from raycaster.rtl.common.widths import index_bits
from raycaster.rtl.span.rect_table import rect_table


@pytest.mark.parametrize("rectangles", [1, 5])
def test_rect_table(rectangles, leaf_of, random):
    config = span_config(screen="tiny", rectangles=rectangles, materials=True)
    leaf = leaf_of(rect_table, config, number=index_bits(config), walk=lambda: Rects(config))
    layout = Rect(config).layout
    known, held = {}, None
    for cycle in range(rectangles + 1 + leaf.some(400)):
        number, index = (int(random.integers(rectangles)) for _ in range(2))
        store, fetch = int(random.random() < 0.4), int(random.random() < 0.4)
        # All are stored first, and then one is fetched.
        if cycle <= rectangles:
            number, store, fetch = cycle % rectangles, int(cycle < rectangles), int(cycle == rectangles)
        rect = {name: int(random.integers(1 << width)) for name, width in layout.items()}
        leaf.case({"store": store, "number": number, "walk_fetch": fetch, "walk_index": index})
        leaf.stimulus[-1] |= {f"rect_{name}": value for name, value in rect.items()}
        leaf.expect({f"walk_rect_{name}": value for name, value in (held or {}).items()})
        if fetch:
            held = known[index]
        if store:
            known[number] = rect
    leaf.check(settled=rectangles + 1)
