# SPDX-License-Identifier: MIT
"""The bits of a serial line in time."""

from myhdl import block, instances

from raycaster.hdl.signals import bits_for, tied, unsigned
from raycaster.hdl.verbs import assign, plus, register

FRACTION = 8
"""Bits of a clock period's share of a bit, at least: the rate is right within 0.2 per cent."""


@block
def bit_timer(clk, restart, tick, clock_hz: int, baud: int, middle: bool):
    """Mark each bit of a byte on a serial line; a bit need not last a whole number of cycles.

    Each mark is within a cycle of its time, at a rate that is right within 0.2 per cent.

    Args:
        clk: the clock, `clock_hz` Hz.
        restart: flag; a byte begins: the first bit's first cycle is the next one for a sender, and this one or the one
            before it for a receiver.
        tick: output strobe: for a sender in the last cycle of each bit from restart on, for a receiver in the middle
            of each bit. Don't care before the first restart.
        clock_hz: frequency of the clock.
        baud: bits per second.
        middle: True for a receiver.
    """
    bits = bits_for(clock_hz // baud + 1) + FRACTION
    whole = 1 << bits
    share = tied(round(whole * baud / clock_hz), bits)
    first = tied(whole // 2 + round(whole * baud / clock_hz) if middle else 0, bits)
    phase = unsigned(bits)
    advanced, advance = plus(phase, share, bits + 1)

    overflow = assign(tick, lambda: advanced[bits])
    keep = register(clk, phase, lambda: first if restart else advanced[bits:])

    return instances()
