# SPDX-License-Identifier: MIT
"""A channel of a pixel: the sum over its rays, one after the other, each with its own share."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import share_bits


@block
def colour_sum(clk, steps, channel, share, blended, config: Configuration):
    """Sum up one channel of a pixel: share times channel, added at each steps.add_colour.

    Without `config.materials` a share has one bit set. With it and at most two reflections, a share is a product of at
    most two numbers from 0 to 4, the quarters that a mirror reflects or keeps. So at most one of its bits in even
    positions is set, and at most one in odd positions: share times channel is a sum of two terms.

    Args:
        steps: `Steps`; only reset_colour, which clears the sum, and add_colour are read.
        channel: unsigned, 8 bits; the channel of the ray's colour, read with steps.add_colour.
        share: unsigned, `share_bits` bits, from colour_share; read with steps.add_colour.
        blended: unsigned output, `config.colour_bits` bits; the top bits of the sum. Valid from the cycle after the
            last addition.
    """
    width = share_bits(config)
    sum_bits = CHANNEL_BITS + width - 1  # all shares add up to 1 << (width - 1)
    low = sum_bits - config.colour_bits

    weighted, total, next_total = (unsigned(sum_bits) for _ in range(3))

    if not config.materials:

        @always_comb
        def weigh():
            weighted.next = channel
            for i in range(1, width):
                if share[i]:
                    weighted.next = channel << i

    elif config.most_reflections > 2:
        weigh = assign(weighted, lambda: channel * share)

    else:
        at_even, at_odd = unsigned(sum_bits), unsigned(sum_bits)

        @always_comb
        def weigh():
            at_even.next = at_odd.next = 0
            for i in range(0, width, 2):
                if share[i]:
                    at_even.next = channel << i
            for i in range(1, width, 2):
                if share[i]:
                    at_odd.next = channel << i

        join = assign(weighted, lambda: (at_even + at_odd) % (1 << sum_bits))

    accumulate = assign(next_total, lambda: (total + weighted) % (1 << sum_bits))

    @always(clk.posedge)
    def add():
        if steps.reset_colour:
            total.next = 0
        elif steps.add_colour:
            total.next = next_total

    take_top = assign(blended, lambda: total[sum_bits:low])

    return instances()
