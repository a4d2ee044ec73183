# SPDX-License-Identifier: MIT
"""Leaf tests of `shade_colour`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

from vectors import check, leaf_of

from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import RGB_BITS, SHADE_BITS
from raycaster.rtl.exact.shade_colour import shade_colour


def test_shade_colour(tmp_path):
    """Every value of a channel with every shade; the three channels have different values."""
    stimulus, expected = [], []
    for value, shade, dark in product(range(256), range(4), (0, 1)):
        colour = (value, 255 - value, value ^ 0x5A)
        channels = dict(zip(("colour_red", "colour_green", "colour_blue"), colour, strict=True))
        stimulus.append({**channels, "dark": dark, "shade": shade})
        shaded = bytes(shade * channel // 4 if dark else channel for channel in colour)
        expected.append({"shaded": int.from_bytes(shaded)})
    leaf = leaf_of(shade_colour, tmp_path, colour=Colour, shade=SHADE_BITS, shaded=RGB_BITS)
    check(leaf, stimulus, expected)
