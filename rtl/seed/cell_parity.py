# SPDX-License-Identifier: MIT
"""The parity of the pattern cell that holds a coordinate."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import PLACE_BITS, SMALLEST_CELL_BITS


@block
def cell_parity(value, size, odd, config: Configuration):
    """Find the lowest bit of floor(value / cell), which chooses a pattern's colour. Combinational.

    A cell as large as the world, or larger, is even.

    Args:
        value: signed; a coordinate within the world, with `config.fraction_bits` fraction bits.
        size: unsigned, 3 bits; log2 of a cell's size in world units, minus three.
        odd: output flag; the lowest bit of floor(value / cell).
    """
    lowest = config.fraction_bits + SMALLEST_CELL_BITS

    @always_comb
    def choose():
        odd.next = False
        for each in range(PLACE_BITS):
            if size == each:
                odd.next = value[lowest + each]

    return instances()
