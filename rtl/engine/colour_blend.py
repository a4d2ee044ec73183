# SPDX-License-Identifier: MIT
"""The colour of a pixel: what its ray and the reflections of it saw, all at once."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.records import Colour
from raycaster.rtl.common.widths import MIRROR_BITS, unsigned
from raycaster.rtl.engine import colour_mean as averaging
from raycaster.rtl.engine import colour_mix as mixing
from raycaster.rtl.engine.colour_mean import colour_mean
from raycaster.rtl.engine.colour_mix import colour_mix


def blend_latency(config: Configuration) -> int:
    """Cycles from what was seen to the pixel."""
    return 1 + (config.reflections * mixing.LATENCY if mixes(config) else averaging.LATENCY)


def mixes(config: Configuration) -> bool:
    """Whether mirrors may show more or less than half."""
    return config.materials and config.reflections > 0


def blends_three(config: Configuration) -> bool:
    """Whether what the second reflection saw is looked at."""
    return config.reflections == 2 or not mixes(config)


@block
def colour_blend(
    clk, found_0, found_1, found_2, colour_0, colour_1, colour_2, mirror_0, mirror_1, picture, pixel,
    config: Configuration,
):  # fmt: skip
    """A pixel a clock, blend_latency cycles later; the background from the first ray that found nothing on.

    found_0, colour_0: what the ray saw; the others: what its reflections saw, 24 bits; mirror_0, mirror_1: how much the
    first two of them mirror, 0 to 4 quarters; pixel: a `Pixel`. What is not needed is None: mirrors that do not mix,
    see `mixes`, and what `blends_three` is not true of.
    """
    colour_bits = config.colour_bits
    first, second, third = Colour(), Colour(), Colour()
    red, green, blue = (unsigned(colour_bits) for _ in range(3))

    @always(clk.posedge)
    def look():
        first.word.next = picture.background
        second.word.next = picture.background
        if found_0:
            first.word.next = colour_0
            if found_1:
                second.word.next = colour_1

    if blends_three(config):

        @always(clk.posedge)
        def look_last():
            third.word.next = picture.background
            if found_0 and found_1 and found_2:
                third.word.next = colour_2

    if mixes(config):
        inner_bits, mixed_bits = CHANNEL_BITS + 2 * (config.reflections - 1), CHANNEL_BITS + 2 * config.reflections
        low_bits = mixed_bits - colour_bits
        own_mirror, near_mirror = unsigned(MIRROR_BITS), unsigned(MIRROR_BITS)
        near = Colour()
        mixed_red, mixed_green, mixed_blue = (unsigned(mixed_bits) for _ in range(3))

        # Of the last hit that a scene asks for, nothing is behind.
        @always(clk.posedge)
        def look_at_mirror():
            own_mirror.next = 0
            if picture.reflections != 0:
                own_mirror.next = mirror_0

        if config.reflections == 2:
            second_mirror = unsigned(MIRROR_BITS)
            far_red, far_green, far_blue = (unsigned(inner_bits) for _ in range(3))
            inner_mixes = [
                colour_mix(clk, near=own, mirror=second_mirror, far=behind, mixed=mixed)
                for own, behind, mixed in (
                    (second.red, third.red, far_red),
                    (second.green, third.green, far_green),
                    (second.blue, third.blue, far_blue),
                )
            ]

            @always(clk.posedge)
            def look_at_second_mirror():
                second_mirror.next = 0
                if picture.reflections == 2:
                    second_mirror.next = mirror_1

            @always(clk.posedge)
            def follow():
                near.word.next = first.word
                near_mirror.next = own_mirror

        else:
            far_red, far_green, far_blue = second.red, second.green, second.blue

            @always_comb
            def follow():
                near.word.next = first.word
                near_mirror.next = own_mirror

        outer_mixes = [
            colour_mix(clk, near=own, mirror=near_mirror, far=behind, mixed=mixed)
            for own, behind, mixed in (
                (near.red, far_red, mixed_red),
                (near.green, far_green, mixed_green),
                (near.blue, far_blue, mixed_blue),
            )
        ]

        @always_comb
        def round_down():
            red.next = mixed_red[:low_bits]
            green.next = mixed_green[:low_bits]
            blue.next = mixed_blue[:low_bits]

    else:
        means = [
            colour_mean(
                clk=clk, first=own, second=behind, third=last, reflections=picture.reflections, mean=mean, config=config
            )
            for own, behind, last, mean in (
                (first.red, second.red, third.red, red),
                (first.green, second.green, third.green, green),
                (first.blue, second.blue, third.blue, blue),
            )
        ]

    @always_comb
    def join():
        pixel.word.next = concat(red, green, blue)

    return instances()
