# SPDX-License-Identifier: MIT
"""Quarters of a weight."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import unsigned


@block
def quarters_of(weight, quarters, share):
    """Compute weight * quarters / 4, which is exact for the weights of a picture. Combinational.

    Args:
        weight: unsigned; a multiple of 4, unless quarters is 0 or 4.
        quarters: unsigned, 3 bits; 0 to 4.
        share: unsigned output, as wide as weight.
    """
    width = len(weight)
    once, twice, four_times, sum_2 = (unsigned(width + 3) for _ in range(4))
    product = unsigned(width + 3)

    @always_comb
    def choose():
        once.next = 0
        twice.next = 0
        four_times.next = 0
        if quarters[0]:
            once.next = weight
        if quarters[1]:
            twice.next = weight << 1
        if quarters[2]:
            four_times.next = weight << 2

    @always_comb
    def add_low():
        sum_2.next = (once + twice) % (1 << (width + 3))

    @always_comb
    def add_high():
        product.next = (sum_2 + four_times) % (1 << (width + 3))

    @always_comb
    def divide():
        share.next = product[width + 2 : 2]

    return instances()
