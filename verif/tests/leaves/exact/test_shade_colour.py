# SPDX-License-Identifier: MIT
"""Leaf tests of `shade_colour`: colours in the light and in the dark."""

from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import RGB_BITS, SHADE_BITS
from raycaster.rtl.exact.shade_colour import shade_colour


def test_shade_colour(tmp_path):
    """Every value of a channel with every shade; the three channels have different values."""
    leaf = Leaf(
        shade_colour,
        lambda: ports("dark", colour=Colour(), shade=unsigned(SHADE_BITS), shaded=unsigned(RGB_BITS)),
        tmp_path,
    )
    stimulus, expected = [], []
    for value in range(256):
        for shade in range(4):
            colour = (value, 255 - value, value ^ 0x5A)
            for dark in (0, 1):
                channels = dict(zip(("colour_red", "colour_green", "colour_blue"), colour, strict=True))
                stimulus.append({**channels, "dark": dark, "shade": shade})
                expected.append(bytes(shade * channel // 4 if dark else channel for channel in colour))
    outputs = leaf.run_both(stimulus)
    assert [output["shaded"].to_bytes(3, "big") for output in outputs] == expected
