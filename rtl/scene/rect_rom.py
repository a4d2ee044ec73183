# SPDX-License-Identifier: MIT
"""The rectangles of a fixed scene, instead of rect_mem."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.fixed import varying_bits
from raycaster.hdl.signals import tied, unsigned
from raycaster.hdl.verbs import assign


@block
def rect_rom(clk, rects, config: Configuration):
    """Present the rectangles of a fixed scene, each in the cycle after its fetch.

    Bits in which all rectangles agree are constants in Verilog, so that synthesis keeps no register for them.

    Args:
        rects: `Rects`; reads index and fetch, drives rect. usable is a constant, and not driven here, as not every
            engine reads it.
        config: the design. config.fixed holds the rectangles.
    """
    table = tuple(rects.rect.pack(vars(rectangle)) for rectangle in config.fixed.rectangles)
    width = len(rects.rect.word)
    varying, same = tied(varying_bits(table), width), tied(table[0] & ~varying_bits(table), width)
    looked_up = unsigned(width)

    @always(clk.posedge)
    def look_up():
        if rects.fetch:
            looked_up.next = table[int(rects.index)]

    present = assign(rects.rect.word, lambda: (looked_up & varying) | same)

    return instances()
