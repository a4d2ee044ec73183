# SPDX-License-Identifier: MIT
"""The colour of a point in the light or in the dark."""

from myhdl import block, instances

from raycaster.configuration import CHANNEL_BITS
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.records import Colour
from raycaster.rtl.engine.quarters_of import QUARTERS_BITS, quarters_of


@block
def shade_colour(colour, dark, shade, shaded):
    """Reduce each channel in the dark to shade quarters, rounded down. Combinational.

    Args:
        colour: `Colour` in the light.
        dark: flag; the light does not reach the point.
        shade: unsigned, 2 bits; the quarters that remain in the dark.
        shaded: unsigned output, 24 bits; red, green and blue of the point.
    """
    quarters, seen = unsigned(QUARTERS_BITS), Colour()
    red, green, blue = (unsigned(CHANNEL_BITS) for _ in range(3))

    choose = assign(quarters, lambda: shade if dark else 4)
    parts = [
        quarters_of(whole=whole, quarters=quarters, share=share)
        for whole, share in ((colour.red, red), (colour.green, green), (colour.blue, blue))
    ]
    joined = seen.joined(red=red, green=green, blue=blue)
    show = assign(shaded, lambda: joined)

    return instances()
