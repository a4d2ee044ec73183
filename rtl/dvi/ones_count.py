# SPDX-License-Identifier: MIT
"""The number of ones in eight bits."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign


@block
def ones_count(bits, count):
    """Count the ones in eight bits. Combinational.

    Args:
        bits: unsigned, 8 bits.
        count: unsigned output, 4 bits; the number of ones in bits, 0 to 8.
    """
    pair_0, pair_1, pair_2, pair_3 = (unsigned(2) for _ in range(4))
    half_0, half_1 = unsigned(3), unsigned(3)

    @always_comb
    def add_bits():
        pair_0.next = bits[0] + bits[1]
        pair_1.next = bits[2] + bits[3]
        pair_2.next = bits[4] + bits[5]
        pair_3.next = bits[6] + bits[7]

    @always_comb
    def add_pairs():
        half_0.next = pair_0 + pair_1
        half_1.next = pair_2 + pair_3

    add_halves = assign(count, lambda: half_0 + half_1)

    return instances()
