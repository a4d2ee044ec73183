# SPDX-License-Identifier: MIT
"""The way of the live rectangles to the units' own tables."""

from myhdl import always_seq, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign, register


@block
def rect_copier(clk, reset, start, rects, store, number, copying, config: Configuration):
    """Fetch all live rectangles once per frame, so that each unit has a copy to read at its own pace.

    Args:
        start: strobe; a frame begins, and its scene is live.
        rects: `Rects`; drives index and fetch.
        store: output strobe; rects.rect is the rectangle of this number.
        number: unsigned, `index_bits` bits; output, valid with store.
        copying: output flag; not all rectangles are stored. From the cycle after start on, for
            `config.rectangles` + 1 cycles.
    """
    last = config.rectangles - 1
    fetching = bit()

    fetch = assign(rects.fetch, lambda: fetching)

    @always_seq(clk.posedge, reset=reset)
    def walk():
        if start:
            fetching.next = True
            rects.index.next = 0
        elif fetching:
            if rects.index == last:
                fetching.next = False
            else:
                rects.index.next = rects.index + 1

    follow = register(clk, (store, number), lambda: (fetching, rects.index))

    show = assign(copying, lambda: fetching or store)

    return instances()
