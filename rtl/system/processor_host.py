# SPDX-License-Identifier: MIT
"""A processor with its memory and peripherals: the Avalon-MM host of a system that runs a program."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.memory_map import BAUD_RATE, MEMORY_WORDS
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.bus_decoder import bus_decoder
from raycaster.rtl.bus.uart_transmitter import DATA_BITS, uart_transmitter
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.interfaces import Access, ProcessorBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.system.button_port import button_port
from raycaster.rtl.system.picorv32 import picorv32


@block
def processor_host(clk, reset, buttons, irq, uart_tx, avm_m0, config: Configuration, program: str):
    """Run a program that accesses its devices at the addresses of memory_map.

    Args:
        buttons: unsigned, 5 bits, active high, as in button_port; they may change at any time.
        irq: level; the ray tracer's interrupt, which the program polls.
        uart_tx: output of the serial port; high while nothing is sent.
        avm_m0: `AvalonPort` to the ray tracer's registers, this block as the host: reads readdata, readdatavalid and
            waitrequest, drives the rest.
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
    clock_hz = config.screen_geometry.clock_hz
    byte_waits, byte_accepted = bit(), bit()
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
        clk, reset, valid=byte_waits, data=byte, ready=byte_accepted, uart_tx=uart_tx, clock_hz=clock_hz,
        baud=BAUD_RATE,
    )  # fmt: skip

    # Only a write that sends a byte has to wait for the one before; a read shows in bit 0 that one is being sent.
    send = assign(byte_waits, lambda: uart.select and bus.strobe[0])

    @always_comb
    def answer():
        uart.ready.next = uart.select and (byte_accepted or not byte_waits)
        uart.word.next = 0
        uart.word.next[0] = not byte_accepted

    invert = assign(resetn, lambda: not reset)

    return instances()
