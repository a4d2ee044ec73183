# SPDX-License-Identifier: MIT
"""In which cell of a pattern a coordinate is."""

from myhdl import always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.engines.engine import SMALLEST_CELL_BITS


@block
def cell_parity(value, size, odd, config: Configuration):
    """odd: the lowest bit of floor(value / a cell), of which size is log2 less three. Combinational.

    value: a coordinate within the world, with the configuration's fraction bits. A cell as large as the world, or
    larger, is even.
    """
    lowest = config.fraction_bits + SMALLEST_CELL_BITS
    sizes = COORDINATE_BITS - SMALLEST_CELL_BITS

    @always_comb
    def choose():
        odd.next = False
        for each in range(sizes):
            if size == each:
                odd.next = value[lowest + each]

    return instances()
