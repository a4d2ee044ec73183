# SPDX-License-Identifier: MIT
"""One channel of the blending."""

from myhdl import always, always_comb, block

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.widths import unsigned


@block
def colour_channel(clk, steps, seen, reflections, blended, config: Configuration):
    """blended = c0, (c0 + c1) >> 1 or (2 * c0 + c1 + c2) >> 2 for 0, 1 or 2 reflections.

    seen: what the ray saw, unsigned, 8 bits, added at steps.add_colour; reflections: at most config.reflections;
    blended: the top colour_bits of the mean, from the cycle after the last addition.
    """
    sum_bits = CHANNEL_BITS + 2  # the weights add up to at most four
    low = CHANNEL_BITS - config.colour_bits

    weighted = unsigned(sum_bits)
    total = unsigned(sum_bits)
    next_total = unsigned(sum_bits)

    # With two reflections the first colour counts twice, so that the weights add up to four.
    @always_comb
    def weigh():
        weighted.next = 0
        if steps.initial_ray and reflections == 2:
            weighted.next[sum_bits - 1 : 1] = seen
        else:
            weighted.next[CHANNEL_BITS:] = seen

    # One addition a ray.
    @always_comb
    def accumulate():
        next_total.next = (total + weighted) % (1 << sum_bits)

    # Gather what the ray and its reflections see.
    @always(clk.posedge)
    def add():
        if steps.reset_colour:
            total.next = 0
        elif steps.add_colour:
            total.next = next_total

    # The mean, without the bits that the monitor does not get.
    @always_comb
    def average():
        if reflections == 2:
            blended.next = total[CHANNEL_BITS + 2 : low + 2]
        elif reflections == 1:
            blended.next = total[CHANNEL_BITS + 1 : low + 1]
        else:
            blended.next = total[CHANNEL_BITS:low]

    return weigh, accumulate, add, average
