# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw, all at once."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import unsigned
from raycaster.rtl.engine import colour_mean as mean
from raycaster.rtl.engine.colour_mean import colour_mean

LATENCY = 1 + mean.LATENCY


@block
def colour_blend(clk, found_0, found_1, found_2, colour_0, colour_1, colour_2, picture, pixel, config: Configuration):
    """A pixel a clock, LATENCY cycles later; the background from the first ray that found nothing on.

    found_0, colour_0: what the ray saw; the others: what its reflections saw, 24 bits; pixel: a `Pixel`.
    """
    first, second, third = Colour(), Colour(), Colour()
    red, green, blue = (unsigned(config.colour_bits) for _ in range(3))
    reds = colour_mean(
        clk=clk, first=first.red, second=second.red, third=third.red, reflections=picture.reflections, mean=red,
        config=config,
    )  # fmt: skip
    greens = colour_mean(
        clk=clk, first=first.green, second=second.green, third=third.green, reflections=picture.reflections, mean=green,
        config=config,
    )  # fmt: skip
    blues = colour_mean(
        clk=clk, first=first.blue, second=second.blue, third=third.blue, reflections=picture.reflections, mean=blue,
        config=config,
    )  # fmt: skip

    @always(clk.posedge)
    def look():
        first.word.next = picture.background
        second.word.next = picture.background
        third.word.next = picture.background
        if found_0:
            first.word.next = colour_0
            if found_1:
                second.word.next = colour_1
                if found_2:
                    third.word.next = colour_2

    @always_comb
    def join():
        pixel.word.next = concat(red, green, blue)

    return instances()
