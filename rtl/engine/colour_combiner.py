# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw."""

from myhdl import ConcatSignal, always, always_comb, block

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.legacy import Colour
from raycaster.rtl.common.widths import RGB_BITS, unsigned
from raycaster.rtl.engine.colour_channel import colour_channel


@block
def colour_combiner(clk, steps, found, found_colour, background, reflections, missed, pixel, config: Configuration):
    """At steps.add_colour, add the colour of the hit that was found; background from the first ray that found none on.

    found_colour, background: 24 bits, red above green above blue; reflections: those of the scene; pixel: the blend,
    3 * colour_bits, from the cycle after the last steps.add_colour; missed: one has found none, from the cycle after
    its steps.add_colour.
    """
    seen = Colour()
    seen_colour = unsigned(RGB_BITS)
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))
    blended = ConcatSignal(red, green, blue)
    channels = [
        colour_channel(clk, steps, seen.red, reflections, red, config),
        colour_channel(clk, steps, seen.green, reflections, green, config),
        colour_channel(clk, steps, seen.blue, reflections, blue, config),
    ]

    # A ray that hit nothing is lost, and so are those that would follow it.
    @always(clk.posedge)
    def remember_miss():
        if steps.reset_colour:
            missed.next = False
        elif steps.add_colour and not found:
            missed.next = True

    # What this ray saw.
    @always_comb
    def look():
        if found and not missed:
            seen_colour.next = found_colour
        else:
            seen_colour.next = background

    # Its three channels.
    @always_comb
    def split():
        seen.red.next = seen_colour[RGB_BITS : 2 * CHANNEL_BITS]
        seen.green.next = seen_colour[2 * CHANNEL_BITS : CHANNEL_BITS]
        seen.blue.next = seen_colour[CHANNEL_BITS:]

    # The three means side by side.
    @always_comb
    def join():
        pixel.next = blended

    return channels, remember_miss, look, split, join
