# SPDX-License-Identifier: MIT
"""Leaf tests of the copy of a scene's rectangles that a unit reads."""

import pytest
from span_vectors import span_config

from raycaster.rtl.common.interfaces import Rects
from raycaster.rtl.common.records import Rect
from raycaster.rtl.span.rect_copier import rect_copier
from raycaster.rtl.span.rect_table import rect_table


@pytest.mark.parametrize("rectangles", [1, 2, 5])
def test_rect_copier(rectangles, leaf_of, random):
    """Frames that begin at any time, also while rectangles are copied; resets."""
    config = span_config(screen="tiny", rectangles=rectangles)
    leaf = leaf_of(rect_copier, config)
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


@pytest.mark.parametrize("rectangles", [1, 5])
def test_rect_table(rectangles, leaf_of, random):
    """Rectangles that are stored and fetched in any order, also in the same cycle."""
    config = span_config(screen="tiny", rectangles=rectangles, materials=True)
    leaf = leaf_of(rect_table, config, walk=lambda: Rects(config))
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
