# SPDX-License-Identifier: MIT
"""The word in which the processor reads the buttons and the ray tracer's interrupt."""

from myhdl import always_comb, block, instances

from raycaster.hdl.internals import SignalType
from raycaster.hdl.signals import unsigned
from raycaster.memory_map import BUTTON_NAMES, INTERRUPT_BIT
from raycaster.rtl.common.synchroniser import synchroniser


@block
def button_port(clk, reset, buttons, irq, word: SignalType):
    """Join the buttons and the ray tracer's interrupt into the word that the processor reads.

    Args:
        buttons: unsigned, 5 bits, active high; from bit 0 on: left, right, up, down, fire, as in
            memory_map.BUTTON_NAMES. They may change at any time, and are seen two cycles later.
        irq: level; the ray tracer's interrupt.
        word: unsigned, 32 bits; output, the buttons in its lowest bits, and irq at bit `INTERRUPT_BIT`.
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
