# SPDX-License-Identifier: MIT
"""A unit's own copy of the live rectangles."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import register


@block
def rect_table(clk, store, number, rect, walk, config: Configuration):
    """Keep rectangles for a unit, and present the one that it fetches.

    Args:
        store: strobe; rect is kept.
        number: unsigned, `index_bits` bits; number of rect, read with store.
        rect: `Rect`; read with store.
        walk: `Rects`; index and fetch are read. rect is an output, a cycle after fetch; it stays until the next fetch.
    """
    words = [unsigned(len(rect.word)) for _ in range(config.rectangles)]

    keep = register(clk, words[number], lambda: rect.word, store)
    present = register(clk, walk.rect.word, lambda: words[walk.index], walk.fetch)

    return instances()
