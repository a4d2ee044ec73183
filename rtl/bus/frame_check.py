# SPDX-License-Identifier: MIT
"""The check of a frame on a serial line."""

from myhdl import always, block, instances

from raycaster.hdl.signals import bits_for, tied, unsigned
from raycaster.rtl.bus.uart_transmitter import DATA_BITS

CHECK_BITS = 32
POLYNOMIAL = 0xEDB8_8320
"""The polynomial of CRC-32, as in Ethernet and zip files; the highest bit is the lowest power."""

RESIDUE = 0xDEBB_20E3
"""State after a sound frame, whose last word is the complement of the state before it."""

CHECK_CYCLES = DATA_BITS + 1
"""Cycles from a byte's strobe until the state includes it, and the next strobe may come."""


@block
def frame_check(clk, clear, add, data, state):
    """Compute a frame's CRC-32, a bit of each byte per cycle, in `CHECK_CYCLES` cycles.

    Args:
        clear: strobe; a frame begins.
        add: strobe; the frame's next byte.
        data: unsigned, 8 bits; read with add.
        state: unsigned, 32 bits; output. The complement of the check of the bytes since clear.
    """
    start, feedback = (1 << CHECK_BITS) - 1, tied(POLYNOMIAL, CHECK_BITS)
    rest = unsigned(DATA_BITS)
    bits_left = unsigned(bits_for(DATA_BITS + 1))

    @always(clk.posedge)
    def step():
        if clear:
            state.next = start
            bits_left.next = 0
        elif add:
            rest.next = data
            bits_left.next = DATA_BITS
        elif bits_left != 0:
            rest.next = rest >> 1
            bits_left.next = bits_left - 1
            if state[0] != rest[0]:
                state.next = (state >> 1) ^ feedback
            else:
                state.next = state >> 1

    return instances()
