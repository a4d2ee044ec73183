# SPDX-License-Identifier: MIT
"""One channel of a pixel whose rays see one after the other."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.widths import unsigned
from raycaster.rtl.engine.colour_average import colour_average


@block
def colour_channel(clk, steps, seen, reflections, blended, config: Configuration):
    """The `colour_average` of what a ray and its reflections saw, each added at steps.add_colour.

    seen: what the ray saw, unsigned, 8 bits; reflections: at most config.reflections; blended: the top colour_bits of
    the mean, from the cycle after the last addition.
    """
    sum_bits = CHANNEL_BITS + 2  # the weights add up to at most four

    weighted, total, next_total = (unsigned(sum_bits) for _ in range(3))
    mean = colour_average(total, reflections, blended, config)

    # With two reflections the first colour counts twice.
    @always_comb
    def weigh():
        weighted.next = 0
        if steps.initial_ray and reflections == 2:
            weighted.next[sum_bits - 1 : 1] = seen
        else:
            weighted.next[CHANNEL_BITS:] = seen

    @always_comb
    def accumulate():
        next_total.next = (total + weighted) % (1 << sum_bits)

    @always(clk.posedge)
    def add():
        if steps.reset_colour:
            total.next = 0
        elif steps.add_colour:
            total.next = next_total

    return instances()
