# SPDX-License-Identifier: MIT
"""The word of one of several records that are side by side, for a list that is looked up in."""

from myhdl import always_comb, block, instances


@block
def word_of(record, word):
    """Connect a record's word to a signal, combinational.

    Args:
        record: a record.
        word: unsigned; output, the record's word in the same cycle.
    """

    @always_comb
    def take():
        word.next = record.word

    return instances()
