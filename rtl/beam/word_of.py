# SPDX-License-Identifier: MIT
"""The word of one of several records side by side, as an element of a lookup list."""

from myhdl import always_comb, block, instances


@block
def word_of(record, word):
    """Connect a record's word to a signal. Combinational.

    Args:
        record: a record.
        word: unsigned; output, the record's word in the same cycle.
    """

    @always_comb
    def take():
        word.next = record.word

    return instances()
