# SPDX-License-Identifier: MIT
"""A step of a restoring division, for one quotient bit."""

from myhdl import Signal, block, concat, instances, intbv

from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign


@block
def divider_step(remainder, digits, divisor, next_remainder, next_digits):
    """Shift remainder and digits left as one, and subtract the divisor if it fits. Combinational.

    The dividend's digits leave on the left, and the quotient's bit, 1 if the divisor fits, enters on the right.

    Args:
        remainder: unsigned, as wide as divisor and less than it.
        digits: unsigned; the remaining digits of the dividend, above the quotient's digits so far.
        divisor: unsigned.
        next_remainder: unsigned output, as wide as divisor; remainder after the step.
        next_digits: unsigned output, as wide as digits; digits after the step.
    """
    width, count = len(divisor), len(digits)
    dividend = unsigned(width + 1)
    difference = Signal(intbv(0, min=-(1 << width), max=1 << (width + 1)))

    bring_down = assign(dividend, lambda: concat(remainder, digits[count - 1]))

    # A negative difference means that the divisor does not fit.
    subtract = assign(difference, lambda: dividend - divisor)
    restore = assign(next_remainder, lambda: dividend[width:] if difference < 0 else difference[width:])
    shift = assign(next_digits, lambda: concat(digits[count - 1 :], difference >= 0))

    return instances()
