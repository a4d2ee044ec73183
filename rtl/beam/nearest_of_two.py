# SPDX-License-Identifier: MIT
"""The nearer of two hits."""

from myhdl import always, always_comb, block, concat, instances, intbv

from raycaster.hdl.signals import bit, unsigned

MULTIPLIER_BITS = 18
"""Width of a factor of one hard multiplier; the remaining bits of a wider denominator use adders."""


@block
def nearest_of_two(clk, first, second, nearest, latency: int):
    """Find the nearer of two candidates, one pair per clock, latency cycles later; the first one at equal t.

    t = numerator / denominator is nearer than another if numerator * other denominator < other numerator * denominator.
    A candidate that is not valid loses; if neither is valid, nearest is not valid either.

    Args:
        clk: the clock.
        first: `Candidate`.
        second: `Candidate`.
        nearest: `Candidate`; output, latency cycles after first and second.
        latency: 2, or 3 if products are registered twice.
    """
    numerator_bits, denominator_bits = len(first.numerator), len(first.denominator)
    product_bits = numerator_bits + denominator_bits
    first_product, second_product = unsigned(product_bits), unsigned(product_bits)
    first_1, second_1 = first.twin(), first.twin()
    take_second = bit()

    @always(clk.posedge)
    def keep():
        first_1.word.next = first.word
        second_1.word.next = second.word

    if denominator_bits > MULTIPLIER_BITS:
        # The part of a product from the bits above a multiplier's width has its own register, and is added in the
        # second cycle.
        high_bits = denominator_bits - MULTIPLIER_BITS
        more_bits = numerator_bits + high_bits
        first_high, second_high = unsigned(high_bits), unsigned(high_bits)
        first_above, second_above, first_more, second_more, first_top, second_top = (
            unsigned(more_bits) for _ in range(6)
        )
        first_low, second_low = (unsigned(numerator_bits + MULTIPLIER_BITS) for _ in range(2))

        @always_comb
        def take_high_bits():
            first_high.next = first.denominator[:MULTIPLIER_BITS]
            second_high.next = second.denominator[:MULTIPLIER_BITS]

        # A sum of shifted numerators, because a product would use a multiplier.
        @always_comb
        def weigh_high_bits():
            first_weight = intbv(0)[more_bits:]
            second_weight = intbv(0)[more_bits:]
            first_sum = intbv(0)[more_bits:]
            second_sum = intbv(0)[more_bits:]
            for i in range(high_bits):
                first_weight[:] = 0
                second_weight[:] = 0
                if second_high[i]:
                    first_weight[:] = first.numerator << i
                if first_high[i]:
                    second_weight[:] = second.numerator << i
                first_sum[:] = first_sum + first_weight
                second_sum[:] = second_sum + second_weight
            first_above.next = first_sum
            second_above.next = second_sum

        @always(clk.posedge)
        def multiply():
            first_low.next = first.numerator * second.denominator[MULTIPLIER_BITS:]
            second_low.next = second.numerator * first.denominator[MULTIPLIER_BITS:]
            first_more.next = first_above
            second_more.next = second_above

        @always_comb
        def add():
            first_top.next = first_low[:MULTIPLIER_BITS] + first_more
            second_top.next = second_low[:MULTIPLIER_BITS] + second_more

        @always_comb
        def join():
            first_product.next = concat(first_top, first_low[MULTIPLIER_BITS:])
            second_product.next = concat(second_top, second_low[MULTIPLIER_BITS:])

    else:

        @always(clk.posedge)
        def multiply():
            first_product.next = first.numerator * second.denominator
            second_product.next = second.numerator * first.denominator

    if latency == 2:
        late_first, late_second, first_way, second_way = first_1, second_1, first_product, second_product
    else:
        late_first, late_second = first.twin(), first.twin()
        first_way, second_way = unsigned(product_bits), unsigned(product_bits)

        @always(clk.posedge)
        def bring():
            late_first.word.next = first_1.word
            late_second.word.next = second_1.word
            first_way.next = first_product
            second_way.next = second_product

    @always_comb
    def compare():
        take_second.next = late_second.valid and ((not late_first.valid) or (second_way < first_way))

    # If the first is taken and is not valid, neither is valid.
    @always(clk.posedge)
    def choose():
        nearest.word.next = late_first.word
        if take_second:
            nearest.word.next = late_second.word

    return instances()
