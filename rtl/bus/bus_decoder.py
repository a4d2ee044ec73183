# SPDX-License-Identifier: MIT
"""The address decoder of the processor's bus."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import bit, tied
from raycaster.hdl.verbs import assign
from raycaster.memory_map import BUTTONS, MEMORY, MEMORY_WORDS, RAY_TRACER, UART
from raycaster.rtl.common.widths import WORD_BITS


@block
def bus_decoder(bus, memory, tracer, uart, buttons_word, tracer_address_bits: int):
    """Select the device at the address of the processor's access, by memory_map, and return its answer. Combinational.

    The buttons answer in the same cycle. So do addresses without a device, which read 0 and ignore writes.

    Args:
        bus: `ProcessorBus`; reads valid and address, drives ready and word.
        memory: `Access` to the memory; drives select, reads ready and word.
        tracer: `Access` to the ray tracer's registers; drives select, reads ready and word.
        uart: `Access` to the serial port; drives select, reads ready and word.
        buttons_word: unsigned, 32 bits; the word to read at the address of the buttons.
        tracer_address_bits: width of the ray tracer's addresses, which count words.
    """
    memory_end = (4 * MEMORY_WORDS - 1).bit_length()
    tracer_end = tracer_address_bits + 2
    memory_place = tied(MEMORY >> memory_end, WORD_BITS - memory_end)
    tracer_place = tied(RAY_TRACER >> tracer_end, WORD_BITS - tracer_end)
    buttons_place, uart_place = tied(BUTTONS, WORD_BITS), tied(UART, WORD_BITS)
    at_memory, at_tracer, at_buttons, at_uart = (bit() for _ in range(4))

    see_memory = assign(at_memory, lambda: bus.address[:memory_end] == memory_place)
    see_tracer = assign(at_tracer, lambda: bus.address[:tracer_end] == tracer_place)
    see_ports = assign((at_buttons, at_uart), lambda: (bus.address == buttons_place, bus.address == uart_place))
    select = assign(
        (memory.select, tracer.select, uart.select),
        lambda: (bus.valid and at_memory, bus.valid and at_tracer, bus.valid and at_uart),
    )

    @always_comb
    def answer():
        bus.ready.next = bus.valid
        bus.word.next = 0
        if at_memory:
            bus.ready.next, bus.word.next = memory.ready, memory.word
        elif at_tracer:
            bus.ready.next, bus.word.next = tracer.ready, tracer.word
        elif at_buttons:
            bus.word.next = buttons_word
        elif at_uart:
            bus.ready.next, bus.word.next = uart.ready, uart.word

    return instances()
