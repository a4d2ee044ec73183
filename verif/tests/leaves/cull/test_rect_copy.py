# SPDX-License-Identifier: MIT
"""`rect_copy`: fetches of both readers in any order; the second gets what the first got last, with the margin added."""

import numpy as np
from vectors import any_place, by, exact_config, named

from raycaster.golden.world import Rectangles
from raycaster.rtl.common.interfaces import Rects
from raycaster.rtl.common.records import WideRect
from raycaster.rtl.cull.rect_copy import rect_copy
from raycaster.verif.expected import sorted_rect


@by(count=[1, 12, 32], margin=[0, 1])
def test_rect_copy(count, margin, leaf_of, random):
    config = exact_config(rectangles=count)
    leaf = leaf_of(rect_copy, config, copy=lambda: Rects(config, rect=WideRect()), margin=margin)
    written, asked = [], []
    for cycle in range(600):
        fetch, index = int(cycle < count or random.random() < 0.3), cycle if cycle < count else random.integers(count)
        # Ask only for rectangles that were fetched long enough ago.
        ask = int(cycle == count + 5 or (cycle > count + 5 and random.random() < 0.7))
        corners = np.array([[any_place(random) for _ in range(3)] for _ in range(2)])
        corners[1, random.integers(3)] = corners[0].copy()[axis := int(random.integers(3))]
        corners[1, axis] = corners[0, axis]
        rect = sorted_rect(Rectangles(corners[None], np.zeros((1, 3), np.uint8), np.ones(1, bool)), 0, "rect")
        del rect["rect_colour"]
        wanted = int(random.integers(count))
        fetches = {"rects_fetch": fetch, "rects_index": index, "copy_fetch": ask, "copy_index": wanted}
        leaf.case(fetches | named("rects", rect))
        further = {"low": -margin, "high": margin}
        written.append(named("copy", {name: rect[name] + further.get(name.rpartition("_")[2], 0) for name in rect}))
        asked.append(wanted if ask else None)
    memory, shown = {}, {}
    for read, wanted in enumerate(asked[:-2]):
        # A rectangle that arrived in the cycle before can be read.
        if read > 1 and leaf.stimulus[read - 2]["rects_fetch"]:
            memory[leaf.stimulus[read - 2]["rects_index"]] = written[read - 1]
        shown = shown if wanted is None else memory[wanted]
        leaf.expected[read + 2] = shown
    leaf.check(settled=count + 8)
