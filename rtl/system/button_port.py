# SPDX-License-Identifier: MIT
"""What the processor reads of the buttons, and of the ray tracer's interrupt."""

from myhdl import always_comb, block, instances

from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.rtl.common.synchroniser import synchroniser
from raycaster.rtl.common.widths import unsigned


@block
def button_port(clk, reset, buttons, irq, word):
    """word: the buttons in its lowest bits, the interrupt's level beside them, 32 bits.

    buttons: as `memory_map.BUTTON_NAMES`, active high; may change at any time, and are seen two cycles later.
    """
    count = len(BUTTON_NAMES)
    held = unsigned(count)

    synchronised = synchroniser(clk, reset, value=buttons, held=held)

    @always_comb
    def join():
        word.next = 0
        word.next[count:] = held
        word.next[INTERRUPT_BIT] = irq

    return instances()
