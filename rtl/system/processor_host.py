# SPDX-License-Identifier: MIT
"""A processor with its memory and peripherals: the Avalon-MM host of a system that runs a program."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, tied, unsigned
from raycaster.memory_map import MEMORY_WORDS, clocks_per_bit
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.interfaces import Access, ProcessorBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.button_port import button_port
from raycaster.rtl.system.picorv32 import picorv32
from raycaster.rtl.system.uart_transmitter import DATA_BITS, uart_transmitter


@block
def processor_host(clk, reset, buttons, irq, uart_tx, avm_m0, config: Configuration, program: str):
    """Run a program that accesses its devices at the addresses of memory_map.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        buttons: unsigned, 5 bits, active high, as in button_port; they may change at any time.
        irq: level; the ray tracer's interrupt, which the program polls.
        uart_tx: output of the serial port; high while nothing is sent.
        avm_m0: `AvalonPort` to the ray tracer's registers, this block as the host: reads readdata, readdatavalid and
            waitrequest, drives the rest.
        config: the design.
        program: the file with the program, as in word_memory.
    """
    bus = ProcessorBus()
    memory, tracer, uart = Access(), Access(), Access()
    resetn = bit()
    buttons_word = unsigned(WORD_BITS)
    tracer_address_bits = len(avm_m0.address)
    memory_address = bus.address(2 + bits_for(MEMORY_WORDS), 2)
    tracer_address = bus.address(2 + tracer_address_bits, 2)
    byte = bus.data(DATA_BITS, 0)
    bit_time = clocks_per_bit(config.screen_geometry.clock_hz)
    low, no_word = tied(0, 1), tied(0, WORD_BITS)

    # A single-cycle shifter and multiplier are worth their size; 64-bit counters are not.
    processor = picorv32(
        clk=clk, resetn=resetn, irq=no_word, mem_valid=bus.valid, mem_ready=bus.ready, mem_addr=bus.address,
        mem_wdata=bus.data, mem_wstrb=bus.strobe, mem_rdata=bus.word, pcpi_wr=low, pcpi_rd=no_word, pcpi_wait=low,
        pcpi_ready=low, ENABLE_COUNTERS64=0, BARREL_SHIFTER=1, ENABLE_FAST_MUL=1, ENABLE_DIV=1,
    )  # fmt: skip
    decoder = bus_decoder(
        bus, memory=memory, tracer=tracer, uart=uart, buttons_word=buttons_word, tracer_address_bits=tracer_address_bits
    )
    program_memory = word_memory(
        clk, reset, access=memory, strobe=bus.strobe, address=memory_address, data=bus.data, words=MEMORY_WORDS,
        program=program,
    )  # fmt: skip
    host = avalon_host(
        clk, reset, access=tracer, strobe=bus.strobe, address=tracer_address, data=bus.data, avm_m0=avm_m0
    )
    port = button_port(clk, reset, buttons=buttons, irq=irq, word=buttons_word)
    transmitter = uart_transmitter(
        clk, reset, access=uart, strobe=bus.strobe, data=byte, uart_tx=uart_tx, clocks_per_bit=bit_time
    )

    @always_comb
    def invert():
        resetn.next = not reset

    return instances()
