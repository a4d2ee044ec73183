# SPDX-License-Identifier: MIT
"""What the processor reads of the buttons, and of the ray tracer's interrupt."""

from myhdl import always_comb, always_seq, block

from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.rtl.common.widths import unsigned


@block
def button_port(clk, reset, buttons, irq, word):
    """buttons: as `memory_map.BUTTON_NAMES`, active high; may change at any time, and are seen two cycles later."""
    count = len(BUTTON_NAMES)
    arriving, held = unsigned(count), unsigned(count)

    # Two registers, as buttons know no clock.
    @always_seq(clk.posedge, reset=reset)
    def synchronise():
        arriving.next = buttons
        held.next = arriving

    # The interrupt's level stands beside them.
    @always_comb
    def join():
        word.next = 0
        word.next[count:] = held
        word.next[INTERRUPT_BIT] = irq

    return synchronise, join
