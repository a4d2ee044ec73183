# SPDX-License-Identifier: MIT
"""A processor with its memory and what else it needs: the Avalon-MM host of a system that runs a program."""

from myhdl import always_comb, block

from raycaster.configuration import Configuration
from raycaster.memory_map import MEMORY_WORDS, clocks_per_bit
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.legacy import ProcessorBus
from raycaster.rtl.common.ties import tied
from raycaster.rtl.common.widths import WORD_BITS, bit, bits_for, unsigned
from raycaster.rtl.system.button_port import button_port
from raycaster.rtl.system.picorv32 import picorv32
from raycaster.rtl.system.uart_transmitter import DATA_BITS, uart_transmitter


@block
def processor_host(
    clk,
    reset,
    buttons,
    irq,
    uart_tx,
    avm_m0_address,
    avm_m0_read,
    avm_m0_write,
    avm_m0_writedata,
    avm_m0_byteenable,
    avm_m0_readdata,
    avm_m0_readdatavalid,
    avm_m0_waitrequest,
    config: Configuration,
    program: str,
):
    """Run a program that finds by `memory_map` what it drives.

    buttons: as `button_port`; irq: the ray tracer's, which the program polls; avm_m0_*: to the ray tracer's registers;
    program: as `word_memory`.
    """
    bus = ProcessorBus()
    resetn = bit()
    select_memory, memory_ready, select_tracer, tracer_ready, select_uart, uart_ready = (bit() for _ in range(6))
    memory_word, tracer_word, buttons_word, uart_word = (unsigned(WORD_BITS) for _ in range(4))
    memory_address = bus.address(2 + bits_for(MEMORY_WORDS), 2)
    tracer_address = bus.address(2 + len(avm_m0_address), 2)
    byte = bus.data(DATA_BITS, 0)
    low, no_word = tied(0, bit()), tied(0, unsigned(WORD_BITS))

    # A shifter and a multiplier that take a cycle are worth their size; counters of 64 bits are not.
    processor = picorv32(
        clk, resetn, bus.valid, bus.ready, bus.address, bus.data, bus.strobe, bus.word, low, no_word, low, low, no_word,
        ENABLE_COUNTERS64=0, BARREL_SHIFTER=1, ENABLE_FAST_MUL=1, ENABLE_DIV=1,
    )  # fmt: skip
    decoder = bus_decoder(
        bus, select_memory, memory_ready, memory_word, select_tracer, tracer_ready, tracer_word, buttons_word,
        select_uart, uart_ready, uart_word, len(avm_m0_address),
    )  # fmt: skip
    memory = word_memory(
        clk, reset, select_memory, bus.strobe, memory_address, bus.data, memory_ready, memory_word, MEMORY_WORDS,
        program,
    )  # fmt: skip
    host = avalon_host(
        clk, reset, select_tracer, bus.strobe, tracer_address, bus.data, tracer_ready, tracer_word, avm_m0_address,
        avm_m0_read, avm_m0_write, avm_m0_writedata, avm_m0_byteenable, avm_m0_readdata, avm_m0_readdatavalid,
        avm_m0_waitrequest,
    )  # fmt: skip
    port = button_port(clk, reset, buttons, irq, buttons_word)
    uart = uart_transmitter(
        clk, reset, select_uart, bus.strobe, byte, uart_ready, uart_word, uart_tx,
        clocks_per_bit(config.screen_geometry.clock_hz),
    )  # fmt: skip

    # The processor's reset is active low.
    @always_comb
    def invert():
        resetn.next = not reset

    return processor, decoder, memory, host, port, uart, invert
