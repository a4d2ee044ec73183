# SPDX-License-Identifier: MIT
"""Quarters of a weight."""

from myhdl import block, instances

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

    choose_once = assign(once, lambda: weight if quarters[0] else 0)
    choose_twice = assign(twice, lambda: weight << 1 if quarters[1] else 0)
    choose_four_times = assign(four_times, lambda: weight << 2 if quarters[2] else 0)
    add_low = assign(sum_2, lambda: (once + twice) % (1 << (width + 3)))
    add_high = assign(product, lambda: (sum_2 + four_times) % (1 << (width + 3)))
    divide = assign(share, lambda: product[width + 2 : 2])

    return instances()
