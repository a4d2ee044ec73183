# SPDX-License-Identifier: MIT
"""Quarters of a weight."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign


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

    add_low = assign(sum_2, lambda: (once + twice) % (1 << (width + 3)))
    add_high = assign(product, lambda: (sum_2 + four_times) % (1 << (width + 3)))
    divide = assign(share, lambda: product[width + 2 : 2])

    return instances()
