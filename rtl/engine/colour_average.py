# SPDX-License-Identifier: MIT
"""The mean of what a ray and its reflections saw, from their weighted sum."""

from myhdl import always_comb, block, instances

from raycaster.configuration import CHANNEL_BITS, Configuration


@block
def colour_average(total, reflections, mean, config: Configuration):
    """The top colour_bits of c0, (c0 + c1) >> 1 or (2 * c0 + c1 + c2) >> 2 for 0, 1 or 2 reflections. Combinational.

    total: c0, c0 + c1 or 2 * c0 + c1 + c2, unsigned, 10 bits: the weights add up to at most four.
    """
    low = CHANNEL_BITS - config.colour_bits

    @always_comb
    def average():
        if reflections == 2:
            mean.next = total[CHANNEL_BITS + 2 : low + 2]
        elif reflections == 1:
            mean.next = total[CHANNEL_BITS + 1 : low + 1]
        else:
            mean.next = total[CHANNEL_BITS:low]

    return instances()
