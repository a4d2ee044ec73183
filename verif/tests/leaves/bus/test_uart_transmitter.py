# SPDX-License-Identifier: MIT
"""Leaf tests of `uart_transmitter`."""

from serial_vectors import BYTE_BITS, levels_of, rates

from raycaster.memory_map import clocks_per_bit
from raycaster.rtl.bus.uart_transmitter import uart_transmitter


def test_clocks_per_bit():
    """Rounded rates are close enough: a receiver tolerates a few per cent."""
    assert [clocks_per_bit(hz) for hz in (50_000_000, 25_000_000, 6_000_000)] == [434, 217, 52]


@rates
def test_uart_transmitter(clock_hz, baud, leaf_of, random):
    """A byte is accepted when the line is free, and each of its bits has its time, rounded up to a cycle."""
    leaf, cycles = leaf_of(uart_transmitter, data=8, clock_hz=clock_hz, baud=baud), clock_hz / baud
    exact = cycles == round(cycles)
    leaf.case({"reset": 1})
    waits, begun, levels = None, 0, []  # the byte that waits, the cycle in which a byte began, and its levels
    for _ in range(leaf.some(6000)):
        if waits is None and random.random() < 0.02:
            waits = int(random.integers(256))
        reset = int(random.random() < 0.1 / (BYTE_BITS * cycles))
        age = leaf.cycle - begun
        # With a rounded rate, an edge may come a cycle early or late; then nothing waits.
        spread = 0 if exact else 1
        earliest, latest = (int((age + off) / cycles) for off in (-spread, spread))
        certain, free = earliest == latest, not levels or earliest >= BYTE_BITS
        valid = waits is not None and (certain or latest < BYTE_BITS or free)
        leaf.case({"reset": reset, "valid": valid, "data": waits if valid else random.integers(256)})
        leaf.expect({"ready": free}, when=free or latest < BYTE_BITS)
        leaf.expect({"uart_tx": 1 if free else levels[earliest]}, when=free or (certain and latest < BYTE_BITS))
        if reset:
            waits, levels = None, []
        elif free and valid:
            begun, levels, waits = leaf.cycle, levels_of([waits]), None
    leaf.check(settled=1)
