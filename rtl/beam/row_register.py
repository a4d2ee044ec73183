# SPDX-License-Identifier: MIT
"""What all columns of a row have in common, for one rectangle."""

from myhdl import always, always_comb, block, instances

from raycaster.rtl.common.widths import unsigned


@block
def row_register(clk, load, given, live, known, word):
    """Keep a record's word from load to load; of a fixed scene, synthesis removes the registers of what is known.

    live: a mask of the bits that load takes from given; known: the other bits' values, 0 where live is 1. Constants.
    """
    loaded, kept = unsigned(len(given)), unsigned(len(given))

    @always(clk.posedge)
    def keep():
        if load:
            loaded.next = given

    @always_comb
    def mask():
        kept.next = loaded & live

    @always_comb
    def insert():
        word.next = kept | known

    return instances()
