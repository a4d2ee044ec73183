# SPDX-License-Identifier: MIT
"""A hit that meets no other in its round."""

from myhdl import always, block

from raycaster.rtl.common.widths import bit, unsigned


@block
def unopposed(clk, first, nearest):
    """What nearest_of_two does to a candidate without a second: it comes out as it is, as late."""
    valid = bit()
    numerator, denominator = unsigned(len(first.numerator)), unsigned(len(first.denominator))
    index = unsigned(len(first.index))

    # As late as the others of its round.
    @always(clk.posedge)
    def wait():
        valid.next = first.valid
        numerator.next = first.numerator
        denominator.next = first.denominator
        index.next = first.index
        nearest.valid.next = valid
        nearest.numerator.next = numerator
        nearest.denominator.next = denominator
        nearest.index.next = index

    return wait
