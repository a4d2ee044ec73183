# SPDX-License-Identifier: MIT
"""The colour of a point in the light or in the dark."""

from myhdl import block, instances

from raycaster.configuration import CHANNEL_BITS
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.records import Colour


@block
def shade_colour(colour, dark, shade, shaded):
    """Reduce each channel in the dark to shade quarters, rounded down. Combinational.

    Args:
        colour: `Colour` in the light.
        dark: flag; the light does not reach the point.
        shade: unsigned, 2 bits; the quarters that remain in the dark.
        shaded: unsigned output, 24 bits; red, green and blue of the point.
    """
    channels = (colour.red, colour.green, colour.blue)
    products = [unsigned(CHANNEL_BITS + 2) for _ in channels]
    red, green, blue = products
    seen = Colour()
    dim = seen.joined(red=red(CHANNEL_BITS + 2, 2), green=green(CHANNEL_BITS + 2, 2), blue=blue(CHANNEL_BITS + 2, 2))

    multiply = assign((red, green, blue), lambda: (shade * colour.red, shade * colour.green, shade * colour.blue))
    choose = assign(shaded, lambda: dim if dark else colour.word)

    return instances()
