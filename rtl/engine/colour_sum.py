# SPDX-License-Identifier: MIT
"""One channel of a pixel whose rays see one after the other, each with a share of its own."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.rtl.common.widths import share_bits, unsigned


@block
def colour_sum(clk, steps, seen, share, blended, config: Configuration):
    """The sum of share times seen, each added at steps.add_colour.

    seen: what the ray saw, unsigned, 8 bits; share: a `colour_share`; blended: the top colour_bits of the sum, from the
    cycle after the last addition.

    Without config.materials a share has one bit. With them and at most two reflections it is a product of at most two
    numbers 0 to 4, a mirror's quarters or what they leave, so of its bits at even places at most one is set, and of
    those at odd places too: two summands make the product.
    """
    places = share_bits(config)
    sum_bits = CHANNEL_BITS + places - 1  # all shares make one, which is 1 << (places - 1)
    low = sum_bits - config.colour_bits

    weighted, total, next_total = (unsigned(sum_bits) for _ in range(3))

    if not config.materials:

        @always_comb
        def weigh():
            weighted.next = seen
            for place in range(1, places):
                if share[place]:
                    weighted.next = seen << place

    elif config.reflections > 2:

        @always_comb
        def weigh():
            weighted.next = seen * share

    else:
        at_even, at_odd = unsigned(sum_bits), unsigned(sum_bits)

        @always_comb
        def weigh():
            at_even.next = 0
            at_odd.next = 0
            for place in range(0, places, 2):
                if share[place]:
                    at_even.next = seen << place
            for place in range(1, places, 2):
                if share[place]:
                    at_odd.next = seen << place

        @always_comb
        def join():
            weighted.next = (at_even + at_odd) % (1 << sum_bits)

    @always_comb
    def accumulate():
        next_total.next = (total + weighted) % (1 << sum_bits)

    @always(clk.posedge)
    def add():
        if steps.reset_colour:
            total.next = 0
        elif steps.add_colour:
            total.next = next_total

    @always_comb
    def take_top():
        blended.next = total[sum_bits:low]

    return instances()
