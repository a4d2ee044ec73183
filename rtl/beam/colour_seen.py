# SPDX-License-Identifier: MIT
"""The colour that a ray adds to its pixel."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import MIRROR_BITS


@block
def colour_seen(clk, reached, seen, picture, found, shade, number: int):
    """Choose the colour that a ray adds to its pixel, `SEEN_LATENCY` cycles later.

    It is the colour that the ray saw or, from the first ray that missed on, the background. The last hit that a scene
    asks for mirrors nothing.

    Args:
        clk: the clock.
        reached: flag; all rays before this one have hit something.
        seen: `Seen` of this ray.
        picture: `Picture` of the live scene; run is not read.
        found: flag; output, combinational: this ray and all before it have hit something.
        shade: `Shade`; output, `SEEN_LATENCY` cycles after seen.
        number: the number of reflections before this ray.
    """
    colour, mirror, here = Colour(), unsigned(MIRROR_BITS), bit()

    @always_comb
    def look():
        here.next = reached and seen.found

    @always_comb
    def report():
        found.next = here

    @always_comb
    def choose():
        colour.word.next = picture.background
        if here:
            colour.word.next = seen.colour

    if shade.has("mirror"):

        @always_comb
        def look_at_mirror():
            mirror.next = 0
            if picture.reflections > number:
                mirror.next = seen.mirror

    added = shade.joined(mirror=mirror, red=colour.red, green=colour.green, blue=colour.blue)

    @always(clk.posedge)
    def keep():
        shade.word.next = added

    return instances()
