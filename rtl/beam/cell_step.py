# SPDX-License-Identifier: MIT
"""A step of the division that finds the pattern cell of a hit."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.rtl.common.widths import SMALLEST_CELL_BITS


@block
def cell_step(clk, before, after, power: int):
    """Find one bit of the quotient of before.rest and before.divisor: a step of restoring division.

    The bit's weight is 1 << power. If nothing is hit, the quotient may be too large, and is don't care.

    Args:
        clk: the clock.
        before: `CellDivision` of power + 1; a new one each cycle.
        after: `CellDivision` of power; output, a cycle after before. odd becomes the quotient's bit if its weight is
            the cell size, and is before.odd otherwise.
        power: the number of the quotient's bit.
    """
    divisor_bits = len(before.divisor)
    size = power - SMALLEST_CELL_BITS

    high = unsigned(divisor_bits + 1)
    difference = signed(divisor_bits + 2)
    rest, remaining = unsigned(divisor_bits), unsigned(divisor_bits + power)
    fits, odd = bit(), bit()

    @always_comb
    def look_at_high():
        high.next = before.rest[:power]

    @always_comb
    def subtract():
        difference.next = high - before.divisor

    @always_comb
    def compare():
        fits.next = difference >= 0

    @always_comb
    def bring_down():
        remaining.next = concat(rest, before.rest[power:])

    # If nothing is hit, the quotient may be too large, and is don't care.
    @always_comb
    def choose():
        rest.next = high[divisor_bits:]
        if fits:
            rest.next = difference[divisor_bits:]
        odd.next = before.odd
        if before.cell == size:
            odd.next = fits

    divided = after.joined(rest=remaining, divisor=before.divisor, cell=before.cell, odd=odd)

    @always(clk.posedge)
    def keep():
        after.word.next = divided

    return instances()
