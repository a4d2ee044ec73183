# SPDX-License-Identifier: MIT
"""The transmitter of the serial port."""

from myhdl import Signal, always_comb, always_seq, block, instances

from raycaster.hdl.signals import bit, bits_for, unsigned

DATA_BITS = 8
FRAME_BITS = 1 + DATA_BITS + 1
"""A start bit, the byte from its lowest bit on, a stop bit."""


@block
def uart_transmitter(clk, reset, access, strobe, data, uart_tx, clocks_per_bit: int):
    """Send each byte that is written; the next one waits until the stop bit of the previous one is over.

    A write with bit 0 of strobe set sends data. Other writes do nothing.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        access: `Access`; reads select, drives ready and word. ready is high with select, except while a byte has to
            wait. Bit 0 of word is 1 while a byte is being sent.
        strobe: unsigned, 4 bits; the bytes that are written, or 0 for a read.
        data: unsigned, 8 bits; the byte to send.
        uart_tx: output; high while nothing is sent.
        clocks_per_bit: the number of clocks that a bit lasts.
    """
    last_clock = clocks_per_bit - 1
    line = Signal(bool(1))
    left = unsigned(DATA_BITS)
    bits_left = unsigned(bits_for(FRAME_BITS + 1))
    clocks = unsigned(bits_for(clocks_per_bit))
    busy, writing, start, bit_end = bit(), bit(), bit(), bit()

    @always_comb
    def decide():
        busy.next = bits_left != 0
        writing.next = access.select and strobe[0]
        start.next = access.select and strobe[0] and (bits_left == 0)
        bit_end.next = clocks == last_clock

    # Only a write that sends a byte has to wait.
    @always_comb
    def answer():
        access.ready.next = access.select and not (writing and busy)
        access.word.next = 0
        access.word.next[0] = busy

    @always_seq(clk.posedge, reset=reset)
    def time():
        if start or bit_end:
            clocks.next = 0
        else:
            clocks.next = clocks + 1

    # Ones follow the byte: the stop bit and the idle line.
    @always_seq(clk.posedge, reset=reset)
    def shift():
        if start:
            line.next = False
            left.next = data
            bits_left.next = FRAME_BITS
        elif busy and bit_end:
            line.next = left[0]
            left.next[DATA_BITS - 1 :] = left[DATA_BITS:1]
            left.next[DATA_BITS - 1] = True
            bits_left.next = bits_left - 1

    @always_comb
    def drive_port():
        uart_tx.next = line

    return instances()
