# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw, one after the other."""

from myhdl import always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import share_bits, unsigned
from raycaster.rtl.engine.colour_share import colour_share
from raycaster.rtl.engine.colour_sum import colour_sum


@block
def colour_combiner(clk, steps, found, found_colour, found_mirror, picture, missed, pixel, config: Configuration):
    """At steps.add_colour, add the colour of the hit that was found; the background from the first ray without one on.

    found_colour: 24 bits; found_mirror: how much it mirrors, 0 to 4 quarters, or None without config.materials; pixel:
    a `Pixel`, valid from the cycle after the last steps.add_colour; missed: a ray has found none, or nothing that
    mirrors, so that what follows does not count, from the cycle after its steps.add_colour.
    """
    seen = Colour()
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))

    share = unsigned(share_bits(config))
    sharing = colour_share(
        clk=clk, steps=steps, found=found, found_mirror=found_mirror, share=share, missed=missed, config=config
    )
    channels = [
        colour_sum(clk=clk, steps=steps, seen=one, share=share, blended=blended, config=config)
        for one, blended in ((seen.red, red), (seen.green, green), (seen.blue, blue))
    ]

    # Of a ray that hit nothing there is no reflection, whatever the units go on to find.
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
