# SPDX-License-Identifier: MIT
"""The chains whose spans are being drawn in their mirrors."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bits_for, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import level_bits


@block
def chain_stack(clk, push, level, kept, frame, config: Configuration):
    """Hold a `Frame` for each level, the number of mirrors of its chain.

    Args:
        push: strobe; stores kept at this level.
        level: unsigned, `level_bits` bits; 0 to the number of reflections, less than that with push. Not read with one
            reflection.
        kept: `Frame`; read with push.
        frame: output `Frame`; that of the level below, don't care at level 0. From the cycle after push on.
        config: the design, with reflections.
    """
    width = bits_for(config.most_reflections)

    if config.most_reflections == 1:
        store = register(clk, frame.word, lambda: kept.word, push)

    else:
        memory = [unsigned(len(kept.word)) for _ in range(1 << width)]
        above, below = unsigned(width), unsigned(width)
        lower = unsigned(level_bits(config))

        descend = assign(lower, lambda: (level - 1) % (1 << len(lower)))

        @always_comb
        def address():
            above.next = level[width:]
            below.next = lower[width:]

        store = register(clk, memory[above], lambda: kept.word, push)
        show = assign(frame.word, lambda: memory[below])

    return instances()
