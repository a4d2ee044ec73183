# SPDX-License-Identifier: MIT
"""The rectangles of a fixed scene, instead of rect_mem."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.fixed import varying_bits
from raycaster.hdl.signals import tied, unsigned
from raycaster.hdl.verbs import assign, register


@block
def rect_rom(clk, rects, config: Configuration):
    """Present the rectangles of a fixed scene, each in the cycle after its fetch.

    Bits in which all rectangles agree are constants in Verilog, so that synthesis keeps no register for them.

    Args:
        rects: `Rects`; reads index and fetch, drives rect. usable is a constant, and not driven here, as not every
            engine reads it.
        config: the design. config.fixed holds the rectangles.
    """
    assert config.fixed
    table = tuple(rects.rect.pack(vars(rectangle)) for rectangle in config.fixed.rectangles)
    width = len(rects.rect.word)
    varying, same = tied(varying_bits(table), width), tied(table[0] & ~varying_bits(table), width)
    looked_up = unsigned(width)

    look_up = register(clk, looked_up, lambda: table[int(rects.index)], rects.fetch)
    present = assign(rects.rect.word, lambda: (looked_up & varying) | same)

    return instances()
