# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw, one after the other."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import unsigned
from raycaster.rtl.engine.colour_channel import colour_channel


@block
def colour_combiner(clk, steps, found, found_colour, picture, missed, pixel, config: Configuration):
    """At steps.add_colour, add the colour of the hit that was found; the background from the first ray without one on.

    found_colour: 24 bits; pixel: a `Pixel`, valid from the cycle after the last steps.add_colour; missed: a ray has
    found none, from the cycle after its steps.add_colour.
    """
    seen = Colour()
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))
    channels = [
        colour_channel(clk=clk, steps=steps, seen=one, reflections=picture.reflections, blended=blended, config=config)
        for one, blended in ((seen.red, red), (seen.green, green), (seen.blue, blue))
    ]

    # Of a ray that hit nothing there is no reflection, whatever the units go on to find.
    @always(clk.posedge)
    def remember_miss():
        if steps.reset_colour:
            missed.next = False
        elif steps.add_colour and not found:
            missed.next = True

    @always_comb
    def look():
        if found and not missed:
            seen.word.next = found_colour
        else:
            seen.word.next = picture.background

    @always_comb
    def join():
        pixel.word.next = concat(red, green, blue)

    return instances()
