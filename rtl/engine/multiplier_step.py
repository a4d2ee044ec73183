# SPDX-License-Identifier: MIT
"""A step of an array multiplication, for one digit."""

from myhdl import block, concat, instances

from raycaster.hdl.signals import Signed, signed
from raycaster.hdl.verbs import assign, minus, plus


@block
def multiplier_step(multiplicand, total, digits, next_total, next_digits, subtract: bool):
    """Add multiplicand to total if digits ends in 1, and shift total and digits right as one. Combinational.

    The multiplier's digits leave on the right, and the product's digits enter on the left.

    Args:
        multiplicand: signed, as wide as total.
        total: signed; the sum so far.
        digits: unsigned; the product's digits so far, above the multiplier's remaining digits.
        next_total: signed output, as wide as total; total after the step.
        next_digits: unsigned output, as wide as digits; digits after the step.
        subtract: the digit is the multiplier's sign, whose weight is negative, so the multiplicand is subtracted.
    """
    width, count = len(total), len(digits)
    addend = signed(width)
    added, add = (minus if subtract else plus)(total, addend, Signed(width + 1))

    select = assign(addend, lambda: multiplicand if digits[0] else 0)
    shift = assign(
        (next_total, next_digits), lambda: (added[width + 1 : 1].signed(), concat(added[0], digits[count:1]))
    )

    return instances()
