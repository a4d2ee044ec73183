# SPDX-License-Identifier: MIT
"""Leaf test of `rect_copier`: frames that begin at any time, also while rectangles are copied; resets."""

import pytest
from span_vectors import span_config

from raycaster.rtl.common.interfaces import Rects
from raycaster.rtl.common.widths import index_bits
from raycaster.rtl.span.rect_copier import rect_copier


@pytest.mark.parametrize("rectangles", [1, 2, 5])
def test_rect_copier(rectangles, leaf_of, random):
    config = span_config(screen="tiny", rectangles=rectangles)
    leaf = leaf_of(rect_copier, config, start=1, rects=lambda: Rects(config), number=index_bits(config))
    leaf.case({"reset": 1, "start": 0})
    leaf.case({"reset": 1})
    ahead, stored, whole = [], None, 0
    for _ in range(leaf.some(900)):
        reset, start = int(random.random() < 0.01), int(random.random() < 0.15)
        leaf.case({"reset": reset, "start": start})
        leaf.expect(
            {"rects_fetch": bool(ahead), "store": stored is not None, "copying": bool(ahead) or stored is not None}
        )
        leaf.expect({"rects_index": ahead[0] if ahead else 0}, when=bool(ahead))
        leaf.expect({"number": stored}, when=stored is not None)
        whole += stored == rectangles - 1
        stored = ahead[0] if ahead else None
        ahead = list(range(rectangles)) if start else ahead[1:]
        if reset:
            ahead = []
    leaf.check(settled=2)
    assert whole > leaf.some(30)
