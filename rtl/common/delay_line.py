# SPDX-License-Identifier: MIT
"""A shift register for records."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.rtl.common.widths import unsigned


@block
def delay_line(clk, word, late_word, cycles: int):
    """late_word is word `cycles` cycles later, at least one."""
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
