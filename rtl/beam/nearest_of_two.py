# SPDX-License-Identifier: MIT
"""The nearer of two hits."""

from myhdl import always, always_comb, block

from raycaster.rtl.common.widths import bit, unsigned

LATENCY = 2


@block
def nearest_of_two(clk, first, second, nearest):
    """Two candidates a clock; the nearer of them follows LATENCY cycles later, the first where both are at one t.

    t = numerator / denominator is nearer than another where numerator * other denominator < other numerator *
    denominator.
    """
    numerator_bits, denominator_bits, index_bits = len(first.numerator), len(first.denominator), len(first.index)
    first_product, second_product = (unsigned(numerator_bits + denominator_bits) for _ in range(2))
    first_valid_1, second_valid_1 = bit(), bit()
    first_numerator_1, second_numerator_1 = unsigned(numerator_bits), unsigned(numerator_bits)
    first_denominator_1, second_denominator_1 = unsigned(denominator_bits), unsigned(denominator_bits)
    first_index_1, second_index_1 = unsigned(index_bits), unsigned(index_bits)
    take_second = bit()

    # Over the common denominator.
    @always(clk.posedge)
    def multiply():
        first_product.next = first.numerator * second.denominator
        second_product.next = second.numerator * first.denominator
        first_valid_1.next = first.valid
        first_numerator_1.next = first.numerator
        first_denominator_1.next = first.denominator
        first_index_1.next = first.index
        second_valid_1.next = second.valid
        second_numerator_1.next = second.numerator
        second_denominator_1.next = second.denominator
        second_index_1.next = second.index

    # Strictly nearer, or alone.
    @always_comb
    def compare():
        take_second.next = second_valid_1 and ((not first_valid_1) or (second_product < first_product))

    # The winner.
    @always(clk.posedge)
    def choose():
        nearest.valid.next = first_valid_1 or second_valid_1
        nearest.numerator.next = first_numerator_1
        nearest.denominator.next = first_denominator_1
        nearest.index.next = first_index_1
        if take_second:
            nearest.numerator.next = second_numerator_1
            nearest.denominator.next = second_denominator_1
            nearest.index.next = second_index_1

    return multiply, compare, choose
