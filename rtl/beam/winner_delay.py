# SPDX-License-Identifier: MIT
"""Which rectangle a ray saw, until its reflection has seen one too."""

from myhdl import always, always_comb, block, concat

from raycaster.rtl.common.widths import unsigned


@block
def winner_delay(clk, valid, index, late_valid, late_index, cycles: int):
    """The same as many cycles later."""
    width = len(index) + 1
    kept_bits = (cycles - 1) * width
    index_bits = len(index)
    line = unsigned(cycles * width)

    # A shift register.
    @always(clk.posedge)
    def shift():
        line.next = concat(line[kept_bits:], index, valid)

    # Its end.
    @always_comb
    def leave():
        late_valid.next = line[kept_bits]
        late_index.next = line[kept_bits + 1 + index_bits : kept_bits + 1]

    return shift, leave
