# SPDX-License-Identifier: MIT
"""The nearer of two hits."""

from myhdl import always, always_comb, block, instances

from raycaster.rtl.common.widths import bit, unsigned

LATENCY = 2


@block
def nearest_of_two(clk, first, second, nearest):
    """Two candidates a clock; the nearer of them follows LATENCY cycles later, the first where both are at one t.

    t = numerator / denominator is nearer than another where numerator * other denominator < other numerator *
    denominator.
    """
    product_bits = len(first.numerator) + len(first.denominator)
    first_product, second_product = unsigned(product_bits), unsigned(product_bits)
    first_1, second_1 = first.twin(), first.twin()
    take_second = bit()

    @always(clk.posedge)
    def multiply():
        first_product.next = first.numerator * second.denominator
        second_product.next = second.numerator * first.denominator
        first_1.word.next = first.word
        second_1.word.next = second.word

    @always_comb
    def compare():
        take_second.next = second_1.valid and ((not first_1.valid) or (second_product < first_product))

    # Where the first is taken and is not valid, neither is.
    @always(clk.posedge)
    def choose():
        nearest.word.next = first_1.word
        if take_second:
            nearest.word.next = second_1.word

    return instances()
