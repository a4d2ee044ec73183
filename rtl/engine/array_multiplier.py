# SPDX-License-Identifier: MIT
"""A multiplier made of adders, to leave the chip's multipliers for other uses."""

from myhdl import block, concat, instances

from raycaster.hdl.signals import Signed, signed, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.engine.multiplier_step import multiplier_step


@block
def array_multiplier(multiplicand, multiplier, product):
    """Multiply two signed numbers with one adder per bit of the multiplier. Combinational.

    Args:
        multiplicand: signed.
        multiplier: signed.
        product: signed output; multiplicand * multiplier, or its low bits if product is narrower than both factors
            together.
    """
    width, count = len(multiplicand), len(multiplier)
    totals = [tied(0, Signed(width)), *(signed(width) for _ in range(count))]
    digits = [unsigned(count) for _ in range(count + 1)]
    first_digits, last_total, last_digits = digits[0], totals[-1], digits[-1]
    whole = signed(width + count)
    kept = len(product)
    steps = [
        multiplier_step(
            multiplicand=multiplicand, total=totals[i], digits=digits[i], next_total=totals[i + 1],
            next_digits=digits[i + 1], subtract=i == count - 1,
        )
        for i in range(count)
    ]  # fmt: skip

    begin = assign(first_digits, lambda: multiplier[count:])
    join = assign(whole, lambda: concat(last_total[width:], last_digits).signed())
    keep = assign(product, lambda: whole[kept:].signed())

    return instances()
