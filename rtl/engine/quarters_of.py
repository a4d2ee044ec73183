# SPDX-License-Identifier: MIT
"""Quarters of a number."""

from myhdl import block, instances

from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign

QUARTERS_BITS = 3
"""Width of a number of quarters, from 0 to 4."""


@block
def quarters_of(whole, quarters, share):
    """Compute whole * quarters / 4, rounded down, without a multiplier. Combinational.

    Args:
        whole: unsigned.
        quarters: unsigned, `QUARTERS_BITS` bits; 0 to 4.
        share: unsigned output, as wide as whole.
    """
    width = len(whole)
    once, twice, four_times, sum_2 = (unsigned(width + 3) for _ in range(4))
    product = unsigned(width + 3)

    choose_once = assign(once, lambda: whole if quarters[0] else 0)
    choose_twice = assign(twice, lambda: whole << 1 if quarters[1] else 0)
    choose_four_times = assign(four_times, lambda: whole << 2 if quarters[2] else 0)
    add_low = assign(sum_2, lambda: (once + twice) % (1 << (width + 3)))
    add_high = assign(product, lambda: (sum_2 + four_times) % (1 << (width + 3)))
    divide = assign(share, lambda: product[width + 2 : 2])

    return instances()
