# SPDX-License-Identifier: MIT
"""One channel of a pixel whose rays have all seen something."""

from myhdl import always, always_comb, block

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.widths import unsigned

LATENCY = 1


@block
def colour_mean(clk, first, second, third, reflections, mean, config: Configuration):
    """c0, (c0 + c1) >> 1 or (2 * c0 + c1 + c2) >> 2 for 0, 1 or 2 reflections, LATENCY cycles later.

    first, second, third: what the ray and its reflections saw, 8 bits; mean: the top colour_bits.
    """
    low = CHANNEL_BITS - config.colour_bits
    doubled = unsigned(CHANNEL_BITS + 1)
    pair, others = unsigned(CHANNEL_BITS + 1), unsigned(CHANNEL_BITS + 1)
    total = unsigned(CHANNEL_BITS + 2)

    # Two weigh as much as the third and the fourth part of it.
    @always_comb
    def weigh():
        doubled.next = first + first
        pair.next = first + second
        others.next = second + third

    # Four quarters.
    @always_comb
    def add():
        total.next = doubled + others

    # The mean, without the bits that the monitor does not get.
    @always(clk.posedge)
    def average():
        if reflections == 2:
            mean.next = total[CHANNEL_BITS + 2 : low + 2]
        elif reflections == 1:
            mean.next = pair[CHANNEL_BITS + 1 : low + 1]
        else:
            mean.next = first[CHANNEL_BITS:low]

    return weigh, add, average
