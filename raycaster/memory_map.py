# SPDX-License-Identifier: MIT
"""Memory map of a system's processor: memory, ray tracer, buttons and serial port."""

from collections.abc import Iterable

MEMORY = 0x0000_0000
"""Byte address of the memory; after reset, the program starts at its first word."""

MEMORY_WORDS = 8192
MEMORY_BYTES = 4 * MEMORY_WORDS

PROGRAM_FILE = "program.hex"
"""Default file with the memory's initial contents: words in hexadecimal, one per line."""

RAY_TRACER = 0x8000_0000
"""Byte address of the ray tracer's first register; the others follow as in the register map."""

BUTTONS = 0x9000_0000
"""Byte address of the word with the held buttons and the ray tracer's interrupt."""

BUTTON_NAMES = ("left", "right", "up", "down", "fire")
"""Buttons by bit, from bit 0 on; 1 means held."""

INTERRUPT_BIT = 8
"""Bit of the buttons' word that has the level of the ray tracer's interrupt."""

UART = 0x9000_0010
"""Byte address of the serial transmitter. A written byte is sent, after waiting for the previous one; a read returns
`UART_BUSY` while a byte is being sent."""

UART_BUSY = 1
"""The bit that reads 1 while a byte is being sent."""

BAUD_RATE = 115_200
"""Baud rate of the serial port: 8 data bits, no parity, one stop bit."""


def held_bits(names: Iterable[str]) -> int:
    """Return the buttons' word in which these buttons are held.

    Raises:
        ValueError: a name is not in `BUTTON_NAMES`.
    """
    return sum(1 << BUTTON_NAMES.index(name) for name in set(names))


def clocks_per_bit(clock_hz: int) -> int:
    """Return the number of system clocks per bit of the serial port, rounded to nearest."""
    return round(clock_hz / BAUD_RATE)


def c_header() -> str:
    """Return the map as a C header with numbers only, so that preprocessed linker scripts can include it."""
    numbers = {
        "RAM_BASE": MEMORY,
        "RAM_BYTES": MEMORY_BYTES,
        "RAYCASTER_BASE": RAY_TRACER,
        "BUTTONS_BASE": BUTTONS,
        "UART_BASE": UART,
        "UART_BUSY": UART_BUSY,
    }
    lines = [f"#define SYSTEM_{name} {number:#x}" for name, number in numbers.items()]
    source = "// Written by `make registers` from raycaster/memory_map.py, which explains it."
    head = ["// SPDX-License-Identifier: MIT", source]
    return "\n".join([*head, "", "#ifndef SYSTEM_H", "#define SYSTEM_H", "", *lines, "", "#endif", ""])
