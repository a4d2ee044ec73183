# SPDX-License-Identifier: MIT
"""The rectangles of a fixed scene, in place of rect_mem."""

from myhdl import always, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.legacy import Rect, SequentialRects
from raycaster.rtl.common.ties import tied, unconnected
from raycaster.rtl.common.widths import index_bits, unsigned

FIELDS = ("axis", "position", "u_low", "u_high", "v_low", "v_high", "colour")


def fixed_rects(rects: SequentialRects, config: Configuration):
    """Take the fields of rects.rect from one word, or make them constants where all of the scene's rectangles agree.

    Returns:
        The word, for rect_rom to drive, and what it is for each rectangle; None and an empty table where all agree.
    """
    columns = {name: config.fixed.column(name) for name in FIELDS}
    widths = {name: len(getattr(Rect(), name)) for name in FIELDS}
    varying = [name for name in FIELDS if len(set(columns[name])) > 1]
    rects.usable = tied((1 << config.rectangles) - 1, rects.usable)
    for name in set(FIELDS) - set(varying):
        setattr(rects.rect, name, tied(columns[name][0], getattr(rects.rect, name)))
    if not varying:
        rects.index, rects.fetch = unconnected(len(rects.index)), unconnected(1)
        return None, ()
    word = unsigned(sum(widths[name] for name in varying))
    table = [0] * config.rectangles
    low = 0
    for name in varying:
        setattr(rects.rect, name, word(low + widths[name], low))
        table = [entry | value << low for entry, value in zip(table, columns[name], strict=True)]
        low += widths[name]
    return word, tuple(table)


@block
def rect_rom(clk, index, fetch, word, table, pipelined: bool, config: Configuration):
    """word is the table's entry a cycle after fetch with its index, or two where it is pipelined, held until the next.

    table: of ints, as `fixed_rects` gives it with the word.
    """
    if not pipelined:
        # Held until the next one is asked for.
        @always(clk.posedge)
        def look_up():
            if fetch:
                word.next = table[int(index)]

        return look_up

    held_index = unsigned(index_bits(config))

    # Held until the next one is asked for.
    @always(clk.posedge)
    def hold():
        if fetch:
            held_index.next = index

    # Looked up a cycle later.
    @always(clk.posedge)
    def look_up_held():
        word.next = table[int(held_index)]

    return hold, look_up_held
