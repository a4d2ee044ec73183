# SPDX-License-Identifier: MIT
"""A register for the data that all columns of a row share, for one rectangle."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import unsigned


@block
def row_register(clk, load, given, live, known, word):
    """Hold the word of a record from load to load.

    Synthesis removes the registers of the bits that are known in a fixed scene.

    Args:
        clk: the clock.
        load: strobe; takes given.
        given: unsigned, as wide as word; read with load.
        live: constant, as wide as word; a mask of the bits that load takes from given.
        known: constant, as wide as word; the values of the other bits, 0 where live is 1.
        word: unsigned; output, valid from the cycle after load on.
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
