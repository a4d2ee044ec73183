# SPDX-License-Identifier: MIT
"""One channel of a pixel whose rays have all seen something."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.widths import unsigned
from raycaster.rtl.engine.colour_average import colour_average

LATENCY = 1


@block
def colour_mean(clk, first, second, third, reflections, mean, config: Configuration):
    """The `colour_average` of what a ray and its reflections saw, LATENCY cycles later.

    first, second, third: what they saw, 8 bits each; mean: the top colour_bits.
    """
    doubled, pair, others = (unsigned(CHANNEL_BITS + 1) for _ in range(3))
    four, total = (unsigned(CHANNEL_BITS + 2) for _ in range(2))
    averaged = unsigned(config.colour_bits)
    average = colour_average(total, reflections, averaged, config)

    @always_comb
    def weigh():
        doubled.next = first + first
        pair.next = first + second
        others.next = second + third

    @always_comb
    def add():
        four.next = doubled + others

    @always_comb
    def choose():
        if reflections == 2:
            total.next = four
        elif reflections == 1:
            total.next = pair
        else:
            total.next = first

    @always(clk.posedge)
    def keep():
        mean.next = averaged

    return instances()
