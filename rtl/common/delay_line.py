# SPDX-License-Identifier: MIT
"""A shift register for records."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.hdl.signals import unsigned


@block
def delay_line(clk, word, late_word, cycles: int):
    """Delay a word by a fixed number of cycles.

    Args:
        clk: the clock.
        word: unsigned.
        late_word: unsigned output, as wide as word; the delayed word.
        cycles: the delay in cycles, at least one.
    """
    kept_bits = (cycles - 1) * len(word)

    if cycles == 1:

        @always(clk.posedge)
        def keep():
            late_word.next = word

    else:
        line = unsigned(cycles * len(word))

        @always(clk.posedge)
        def shift():
            line.next = concat(line[kept_bits:], word)

        @always_comb
        def leave():
            late_word.next = line[:kept_bits]

    return instances()
