# SPDX-License-Identifier: MIT
"""Leaf test of `shade_colour`: every value of a channel with every shade; the three channels have different values."""

from itertools import product

from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import RGB_BITS, SHADE_BITS
from raycaster.rtl.engine.shade_colour import shade_colour


def test_shade_colour(leaf_of):
    leaf = leaf_of(shade_colour, colour=Colour, shade=SHADE_BITS, shaded=RGB_BITS)
    for value, shade, dark in product(range(256), range(4), (0, 1)):
        colour = (value, 255 - value, value ^ 0x5A)
        channels = dict(zip(("colour_red", "colour_green", "colour_blue"), colour, strict=True))
        shaded = bytes(shade * channel // 4 if dark else channel for channel in colour)
        leaf.case({**channels, "dark": dark, "shade": shade}, {"shaded": int.from_bytes(shaded)})
    leaf.check()
