# SPDX-License-Identifier: MIT
"""The surfaces that rays see on their way, as they were painted."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import level_bits


@block
def surface_table(clk, paint, level, given, seen, shown, config: Configuration):
    """Hold the surface of each level, the number of mirrors before it.

    Args:
        paint: strobe; from now on a ray sees this surface at this level.
        level: unsigned, `level_bits` bits; read with paint.
        given: `Paint`; read with paint.
        seen: unsigned, `level_bits` bits; the level that is read.
        shown: output `Paint`; that of this level. Combinational.
    """
    memory = [unsigned(len(given.word)) for _ in range(1 << level_bits(config))]

    keep = register(clk, memory[level], lambda: given.word, paint)
    show = assign(shown.word, lambda: memory[seen])

    return instances()
