# SPDX-License-Identifier: MIT
"""A record as it was some cycles ago: a winner until its reflection has one too, or who is unopposed in a round."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import unsigned


@block
def winner_delay(clk, word, late_word, cycles: int):
    """late_word is word as many cycles later, at least one: a shift register."""
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
