# SPDX-License-Identifier: MIT
"""The colour of a pixel, added up from its ray and the ray's reflections one after the other."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import share_bits
from raycaster.rtl.engine.colour_share import colour_share
from raycaster.rtl.engine.colour_sum import colour_sum


@block
def colour_combiner(clk, steps, found, found_colour, found_mirror, picture, missed, pixel, config: Configuration):
    """Add up a pixel's colour from the hits of its ray and the ray's reflections, one at each steps.add_colour.

    From the first ray that misses on, the background is added.

    Args:
        steps: `Steps`; reset_colour, add_colour and store_ray are read.
        found: flag; the ray has a hit. Read with steps.add_colour.
        found_colour: unsigned, 24 bits; the colour of the hit, read with steps.add_colour.
        found_mirror: unsigned, 3 bits; the share that the hit mirrors, 0 to 4 quarters. Read with steps.add_colour,
            only with `config.materials`.
        picture: `Picture`; only background is read, with steps.add_colour.
        missed: output flag; a ray has hit nothing, or no mirror, so later hits do not count. Valid from the cycle after
            that ray's steps.add_colour.
        pixel: output `Pixel`; valid from the cycle after the last steps.add_colour.
    """
    ray_colour = Colour()
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))

    share = unsigned(share_bits(config))
    sharing = colour_share(
        clk=clk, steps=steps, found=found, found_mirror=found_mirror, share=share, missed=missed, config=config
    )
    channels = [
        colour_sum(clk=clk, steps=steps, channel=one, share=share, blended=total, config=config)
        for one, total in ((ray_colour.red, red), (ray_colour.green, green), (ray_colour.blue, blue))
    ]

    # A ray that missed has no reflection, whatever the units find afterwards.
    look = assign(ray_colour.word, lambda: found_colour if found and not missed else picture.background)

    blended = pixel.joined(red=red, green=green, blue=blue)
    join = assign(pixel.word, lambda: blended)

    return instances()
