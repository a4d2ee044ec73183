# SPDX-License-Identifier: MIT
"""The entries of all chains from the camera to the present one, and those that shade their surfaces."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import register
from raycaster.rtl.common.widths import index_bits, level_bits


@block
def entry_table(clk, level, shadows, append, number, entry, read, place, stored, config: Configuration):
    """Hold a table of entries for each level, the number of mirrors of a chain.

    Args:
        level: unsigned, `level_bits` bits; the level that is written or read.
        shadows: flag, read with `config.light`; the table of what shades the level's surface, instead of that of its
            chain.
        append: strobe; stores entry at number. Not with read, for which block RAM would need more logic.
        number: unsigned, `count_bits` bits; read with append.
        entry: `Entry`; read with append.
        read: strobe; reads the entry at place.
        place: unsigned, `index_bits` bits; read with the strobe of that name.
        stored: output `Entry`; valid from the cycle after read up to the next read.
    """
    index_width = index_bits(config)
    leveled = config.most_reflections > 0
    address_bits = index_width + (level_bits(config) if leveled else 0) + config.light
    memory = [unsigned(len(entry.word)) for _ in range(1 << address_bits)]
    write_address, read_address = unsigned(address_bits), unsigned(address_bits)

    if leveled and config.light:

        @always_comb
        def address():
            write_address.next = concat(shadows, level, number[index_width:])
            read_address.next = concat(shadows, level, place)

    elif config.light:

        @always_comb
        def address():
            write_address.next = concat(shadows, number[index_width:])
            read_address.next = concat(shadows, place)

    elif leveled:

        @always_comb
        def address():
            write_address.next = concat(level, number[index_width:])
            read_address.next = concat(level, place)

    else:

        @always_comb
        def address():
            write_address.next = number[index_width:]
            read_address.next = place

    store = register(clk, memory[write_address], lambda: entry.word, append)

    @always(clk.posedge)
    def fetch():
        if read and not append:
            stored.word.next = memory[read_address]

    return instances()
