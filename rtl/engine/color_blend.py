# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw, all at once."""

from myhdl import always, block

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.interfaces import Colour
from raycaster.rtl.common.widths import COLOUR_BITS
from raycaster.rtl.engine import color_mean as mean
from raycaster.rtl.engine.color_mean import color_mean

LATENCY = 1 + mean.LATENCY


@block
def color_blend(
    clk,
    found_0,
    found_1,
    found_2,
    color_0,
    color_1,
    color_2,
    background,
    reflections,
    red,
    green,
    blue,
    config: Configuration,
):
    """A pixel a clock, LATENCY cycles later; background from the first ray that found nothing on.

    found_0, color_0: what the ray saw; the others: what its reflections saw, 24 bits, red above green above blue.
    """
    first, second, third = Colour(), Colour(), Colour()
    red_mean = color_mean(clk, first.red, second.red, third.red, reflections, red, config)
    green_mean = color_mean(clk, first.green, second.green, third.green, reflections, green, config)
    blue_mean = color_mean(clk, first.blue, second.blue, third.blue, reflections, blue, config)

    # What the ray saw.
    @always(clk.posedge)
    def look():
        if found_0:
            first.red.next = color_0[COLOUR_BITS : 2 * CHANNEL_BITS]
            first.green.next = color_0[2 * CHANNEL_BITS : CHANNEL_BITS]
            first.blue.next = color_0[CHANNEL_BITS:]
        else:
            first.red.next = background[COLOUR_BITS : 2 * CHANNEL_BITS]
            first.green.next = background[2 * CHANNEL_BITS : CHANNEL_BITS]
            first.blue.next = background[CHANNEL_BITS:]

    # What its reflection saw.
    @always(clk.posedge)
    def look_again():
        if found_0 and found_1:
            second.red.next = color_1[COLOUR_BITS : 2 * CHANNEL_BITS]
            second.green.next = color_1[2 * CHANNEL_BITS : CHANNEL_BITS]
            second.blue.next = color_1[CHANNEL_BITS:]
        else:
            second.red.next = background[COLOUR_BITS : 2 * CHANNEL_BITS]
            second.green.next = background[2 * CHANNEL_BITS : CHANNEL_BITS]
            second.blue.next = background[CHANNEL_BITS:]

    # And the reflection of that.
    @always(clk.posedge)
    def look_once_more():
        if found_0 and found_1 and found_2:
            third.red.next = color_2[COLOUR_BITS : 2 * CHANNEL_BITS]
            third.green.next = color_2[2 * CHANNEL_BITS : CHANNEL_BITS]
            third.blue.next = color_2[CHANNEL_BITS:]
        else:
            third.red.next = background[COLOUR_BITS : 2 * CHANNEL_BITS]
            third.green.next = background[2 * CHANNEL_BITS : CHANNEL_BITS]
            third.blue.next = background[CHANNEL_BITS:]

    return red_mean, green_mean, blue_mean, look, look_again, look_once_more
