# SPDX-License-Identifier: MIT
"""One digit of an array multiplication."""

from myhdl import always_comb, block, concat, instances

from raycaster.rtl.common.widths import signed


@block
def multiplier_step(multiplicand, total, digits, next_total, next_digits, subtract: bool):
    """Add the multiplicand to total where digits end in 1, and shift total and digits right as one. Combinational.

    multiplicand, total, next_total: signed, of one width; digits, next_digits: unsigned, of another: the multiplier's
    digits leave on the right, and the product's enter on the left. subtract: the digit is the multiplier's sign, which
    counts below 0.
    """
    width, count = len(total), len(digits)
    addend = signed(width)
    added = signed(width + 1)

    @always_comb
    def select():
        if digits[0]:
            addend.next = multiplicand
        else:
            addend.next = 0

    if subtract:

        @always_comb
        def add():
            added.next = total - addend

    else:

        @always_comb
        def add():
            added.next = total + addend

    @always_comb
    def shift():
        next_total.next = added[width + 1 : 1].signed()
        next_digits.next = concat(added[0], digits[count:1])

    return instances()
