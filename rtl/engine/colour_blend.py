# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw, all at once."""

from myhdl import always, block

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.legacy import Colour
from raycaster.rtl.common.widths import RGB_BITS
from raycaster.rtl.engine import colour_mean as mean
from raycaster.rtl.engine.colour_mean import colour_mean

LATENCY = 1 + mean.LATENCY


@block
def colour_blend(
    clk,
    found_0,
    found_1,
    found_2,
    colour_0,
    colour_1,
    colour_2,
    background,
    reflections,
    red,
    green,
    blue,
    config: Configuration,
):
    """A pixel a clock, LATENCY cycles later; background from the first ray that found nothing on.

    found_0, colour_0: what the ray saw; the others: what its reflections saw, 24 bits, red above green above blue.
    """
    first, second, third = Colour(), Colour(), Colour()
    red_mean = colour_mean(clk, first.red, second.red, third.red, reflections, red, config)
    green_mean = colour_mean(clk, first.green, second.green, third.green, reflections, green, config)
    blue_mean = colour_mean(clk, first.blue, second.blue, third.blue, reflections, blue, config)

    # What the ray saw.
    @always(clk.posedge)
    def look():
        if found_0:
            first.red.next = colour_0[RGB_BITS : 2 * CHANNEL_BITS]
            first.green.next = colour_0[2 * CHANNEL_BITS : CHANNEL_BITS]
            first.blue.next = colour_0[CHANNEL_BITS:]
        else:
            first.red.next = background[RGB_BITS : 2 * CHANNEL_BITS]
            first.green.next = background[2 * CHANNEL_BITS : CHANNEL_BITS]
            first.blue.next = background[CHANNEL_BITS:]

    # What its reflection saw.
    @always(clk.posedge)
    def look_again():
        if found_0 and found_1:
            second.red.next = colour_1[RGB_BITS : 2 * CHANNEL_BITS]
            second.green.next = colour_1[2 * CHANNEL_BITS : CHANNEL_BITS]
            second.blue.next = colour_1[CHANNEL_BITS:]
        else:
            second.red.next = background[RGB_BITS : 2 * CHANNEL_BITS]
            second.green.next = background[2 * CHANNEL_BITS : CHANNEL_BITS]
            second.blue.next = background[CHANNEL_BITS:]

    # And the reflection of that.
    @always(clk.posedge)
    def look_once_more():
        if found_0 and found_1 and found_2:
            third.red.next = colour_2[RGB_BITS : 2 * CHANNEL_BITS]
            third.green.next = colour_2[2 * CHANNEL_BITS : CHANNEL_BITS]
            third.blue.next = colour_2[CHANNEL_BITS:]
        else:
            third.red.next = background[RGB_BITS : 2 * CHANNEL_BITS]
            third.green.next = background[2 * CHANNEL_BITS : CHANNEL_BITS]
            third.blue.next = background[CHANNEL_BITS:]

    return red_mean, green_mean, blue_mean, look, look_again, look_once_more
