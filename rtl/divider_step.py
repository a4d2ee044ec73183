# SPDX-License-Identifier: MIT
"""One bit of a restoring division."""

from myhdl import Signal, always_comb, block, intbv

from raycaster.rtl.widths import unsigned


@block
def divider_step(remainder, digit, divisor, next_remainder, quotient_bit):
    """Bring a digit of the dividend down, and subtract the divisor where it fits. Combinational.

    remainder, divisor, next_remainder: unsigned, of one width, remainder < divisor; digit, quotient_bit: 1 bit.
    """
    width = len(divisor)
    dividend = unsigned(width + 1)
    difference = Signal(intbv(0, min=-(1 << width), max=1 << (width + 1)))

    # The next digit joins the remainder on the right.
    @always_comb
    def bring_down():
        dividend.next[width + 1 : 1] = remainder
        dividend.next[0] = digit

    # Try the subtraction; a negative difference says that the divisor did not fit.
    @always_comb
    def subtract():
        difference.next = dividend - divisor

    # Keep the difference where the divisor fitted, the undiminished dividend where it did not.
    @always_comb
    def restore():
        if difference < 0:
            quotient_bit.next = 0
            next_remainder.next = dividend[width:]
        else:
            quotient_bit.next = 1
            next_remainder.next = difference[width:]

    return bring_down, subtract, restore
