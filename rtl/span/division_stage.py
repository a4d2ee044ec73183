# SPDX-License-Identifier: MIT
"""A stage of a pipelined division."""

from myhdl import always, block, instances

from raycaster.hdl.signals import unsigned
from raycaster.rtl.engine.divider_step import divider_step


@block
def division_stage(clk, remainder, digits, divisor, next_remainder, next_digits, next_divisor, *, steps: int):
    """Keep a division in registers, and take its next steps: one or two bits of the quotient.

    Args:
        remainder: unsigned, as wide as divisor and less than it.
        digits: unsigned; the remaining digits of the dividend, above the quotient's digits so far.
        divisor: unsigned.
        next_remainder: unsigned output, as wide as divisor; remainder after the steps, a cycle later.
        next_digits: unsigned output, as wide as digits; digits after the steps, a cycle later.
        next_divisor: unsigned output, as wide as divisor; the divisor, a cycle later.
        steps: 1 or 2.
    """
    kept_remainder, kept_digits = unsigned(len(remainder)), unsigned(len(digits))

    @always(clk.posedge)
    def keep():
        kept_remainder.next, kept_digits.next, next_divisor.next = remainder, digits, divisor

    if steps == 1:
        first = divider_step(
            remainder=kept_remainder, digits=kept_digits, divisor=next_divisor, next_remainder=next_remainder,
            next_digits=next_digits,
        )  # fmt: skip
    else:
        half_remainder, half_digits = unsigned(len(remainder)), unsigned(len(digits))
        first = divider_step(
            remainder=kept_remainder, digits=kept_digits, divisor=next_divisor, next_remainder=half_remainder,
            next_digits=half_digits,
        )  # fmt: skip
        second = divider_step(
            remainder=half_remainder, digits=half_digits, divisor=next_divisor, next_remainder=next_remainder,
            next_digits=next_digits,
        )  # fmt: skip

    return instances()
