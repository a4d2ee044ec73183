# SPDX-License-Identifier: MIT
"""The receiver of a serial port."""

from myhdl import always_seq, block, instances

from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.bus.bit_timer import bit_timer
from raycaster.rtl.bus.uart_transmitter import DATA_BITS, FRAME_BITS
from raycaster.rtl.common.synchroniser import synchroniser


@block
def uart_receiver(clk, reset, uart_rx, received, data, clock_hz: int, baud: int):
    """Receive bytes of 8 data bits without parity, each bit sampled once, less than a cycle from its middle.

    A start bit that is high in its middle is no byte, and a byte without a stop bit is dropped. A line that stays low
    is idle.

    Args:
        clk: the clock, `clock_hz` Hz.
        uart_rx: the line, high while nothing is sent; it may change at any time.
        received: output strobe, in the cycle after the middle of the stop bit.
        data: unsigned, 8 bits; output, valid with received and until the next start bit.
        clock_hz: frequency of the clock.
        baud: bits per second.
    """
    line, was_high, falls, middle = (bit() for _ in range(4))
    bits_left = unsigned(bits_for(FRAME_BITS + 1))

    synchronised = synchroniser(clk, reset, value=uart_rx, held=line)
    timer = bit_timer(clk, restart=falls, tick=middle, clock_hz=clock_hz, baud=baud, middle=True)

    see_start = assign(falls, lambda: (bits_left == 0) and was_high and not line)

    @always_seq(clk.posedge, reset=reset)
    def follow():
        was_high.next = line
        received.next = False
        if falls:
            bits_left.next = FRAME_BITS
        elif middle and bits_left != 0:
            bits_left.next = bits_left - 1
            if bits_left == 1:
                received.next = line
            else:
                data.next[DATA_BITS - 1 :] = data[DATA_BITS:1]
                data.next[DATA_BITS - 1] = line
            if bits_left == FRAME_BITS and line:
                bits_left.next = 0

    return instances()
