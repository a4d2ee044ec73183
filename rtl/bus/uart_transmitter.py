# SPDX-License-Identifier: MIT
"""The transmitter of a serial port."""

from myhdl import Signal, always_seq, block, instances

from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.bus.bit_timer import bit_timer

DATA_BITS = 8
FRAME_BITS = 1 + DATA_BITS + 1
"""A start bit, the byte from its lowest bit on, a stop bit."""


@block
def uart_transmitter(clk, reset, valid, data, ready, uart_tx, clock_hz: int, baud: int):
    """Send bytes with 8 data bits, without parity; the next one waits until the stop bit of the previous one is over.

    Args:
        clk: the clock, `clock_hz` Hz.
        valid: flag; data waits to be accepted.
        data: unsigned, 8 bits; read in the cycle in which valid and ready are high.
        ready: output flag; data is accepted at the end of this cycle. Low while a byte is being sent.
        uart_tx: output; high while nothing is sent.
        clock_hz: frequency of the clock.
        baud: bits per second.
    """
    line = Signal(bool(1))
    left = unsigned(DATA_BITS)
    bits_left = unsigned(bits_for(FRAME_BITS + 1))
    free, start, bit_end = bit(), bit(), bit()

    timer = bit_timer(clk, restart=start, tick=bit_end, clock_hz=clock_hz, baud=baud, middle=False)

    decide = assign((free, start), lambda: (bits_left == 0, valid and (bits_left == 0)))

    # Ones follow the byte: the stop bit and the idle line.
    @always_seq(clk.posedge, reset=reset)
    def shift():
        if start:
            line.next = False
            left.next = data
            bits_left.next = FRAME_BITS
        elif bit_end and not free:
            line.next = left[0]
            left.next[DATA_BITS - 1 :] = left[DATA_BITS:1]
            left.next[DATA_BITS - 1] = True
            bits_left.next = bits_left - 1

    drive_ports = assign((ready, uart_tx), lambda: (free, line))

    return instances()
