# SPDX-License-Identifier: MIT
"""A step of the division that tells in which cell of a pattern a ray hits."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.engines.engine import SMALLEST_CELL_BITS
from raycaster.rtl.common.widths import bit, signed, unsigned


@block
def cell_step(clk, before, after, place: int):
    """The bit of worth 1 << place of the quotient of before's rest and divisor (restoring division), a cycle later.

    before, after: a `CellDivision` of place + 1 and of place; its odd becomes that bit where a cell is that large.
    """
    divisor_bits = len(before.divisor)
    size = place - SMALLEST_CELL_BITS

    high = unsigned(divisor_bits + 1)
    difference = signed(divisor_bits + 2)
    rest = unsigned(divisor_bits)
    fits, odd = bit(), bit()

    @always_comb
    def look_at_high():
        high.next = before.rest[:place]

    @always_comb
    def subtract():
        difference.next = high - before.divisor

    @always_comb
    def compare():
        fits.next = difference >= 0

    # Where nothing is hit the quotient may be too large, and is don't care.
    @always_comb
    def choose():
        rest.next = high[divisor_bits:]
        if fits:
            rest.next = difference[divisor_bits:]
        odd.next = before.odd
        if before.cell == size:
            odd.next = fits

    @always(clk.posedge)
    def keep():
        after.word.next = concat(rest, before.rest[place:], before.divisor, before.cell, odd)

    return instances()
