# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw."""

from myhdl import ConcatSignal, always, always_comb, block

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.interfaces import Colour
from raycaster.rtl.common.widths import COLOUR_BITS, unsigned
from raycaster.rtl.engine.color_channel import color_channel


@block
def color_combiner(clk, steps, found, found_color, background, reflections, missed, pixel, config: Configuration):
    """At steps.add_color, add the colour of the hit that was found; background from the first ray that found none on.

    found_color, background: 24 bits, red above green above blue; reflections: those of the scene; pixel: the blend,
    3 * colour_bits, from the cycle after the last steps.add_color; missed: one has found none, from the cycle after its
    steps.add_color.
    """
    seen = Colour()
    seen_color = unsigned(COLOUR_BITS)
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))
    blended = ConcatSignal(red, green, blue)
    channels = [
        color_channel(clk, steps, seen.red, reflections, red, config),
        color_channel(clk, steps, seen.green, reflections, green, config),
        color_channel(clk, steps, seen.blue, reflections, blue, config),
    ]

    # A ray that hit nothing is lost, and so are those that would follow it.
    @always(clk.posedge)
    def remember_miss():
        if steps.reset_color:
            missed.next = False
        elif steps.add_color and not found:
            missed.next = True

    # What this ray saw.
    @always_comb
    def look():
        if found and not missed:
            seen_color.next = found_color
        else:
            seen_color.next = background

    # Its three channels.
    @always_comb
    def split():
        seen.red.next = seen_color[COLOUR_BITS : 2 * CHANNEL_BITS]
        seen.green.next = seen_color[2 * CHANNEL_BITS : CHANNEL_BITS]
        seen.blue.next = seen_color[CHANNEL_BITS:]

    # The three means side by side.
    @always_comb
    def join():
        pixel.next = blended

    return channels, remember_miss, look, split, join
