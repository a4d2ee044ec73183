# SPDX-License-Identifier: MIT
"""Serial lines in leaf tests: rates, the levels of bytes in time, and the bytes in levels."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from vectors import by

rates = by(clock_hz=[25_000_000], baud=[3_500_000, 3_000_000, 3_125_000])
"""A clock of 7.14, 8.33 and 8 cycles per bit; the fewest that a design may have are 7.02."""

BYTE_BITS = 10


def levels_of(data: Iterable[int]) -> list[int]:
    """Return the levels of bytes, one per bit: start bit, the bits from the lowest on, stop bit."""
    return [level for byte in data for level in (0, *(byte >> at & 1 for at in range(8)), 1)]


def in_time(levels: Sequence[int], cycles: float, offset: float = 0.0) -> list[int]:
    """Return the level in each cycle, given a bit's length in cycles, and the idle line's before it."""
    count = round(len(levels) * cycles)
    return [levels[max(0, min(len(levels) - 1, int((cycle - offset) / cycles)))] if cycle >= offset else 1
            for cycle in range(count)]  # fmt: skip


def bytes_in(line: Sequence[int], cycles: float) -> list[tuple[int, int]]:
    """Return the bytes on a line, each with the cycle in which its start bit begins; there must be a stop bit."""
    found, cycle = [], 1
    while cycle < len(line):
        if line[cycle - 1] and not line[cycle]:
            bits = [line[min(len(line) - 1, int(cycle + (place + 0.5) * cycles))] for place in range(BYTE_BITS)]
            assert bits[0] == 0 and bits[-1] == 1, f"cycle {cycle}: {bits}"
            found.append((sum(bit << place for place, bit in enumerate(bits[1:-1])), cycle))
            cycle += int((BYTE_BITS - 0.5) * cycles)
        cycle += 1
    return found
