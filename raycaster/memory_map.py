# SPDX-License-Identifier: MIT
"""What the processor of a system finds where: its memory, the ray tracer, the buttons and the serial port."""

from collections.abc import Iterable

MEMORY = 0x0000_0000
"""Byte address of the memory, which holds the program; reset starts it at its first word."""

MEMORY_WORDS = 8192
MEMORY_BYTES = 4 * MEMORY_WORDS

PROGRAM_FILE = "program.hex"
"""What the memory is loaded from, unless told otherwise: its words in hexadecimal, one a line."""

RAY_TRACER = 0x8000_0000
"""Byte address of the ray tracer's first register; the others follow as the register map has them."""

BUTTONS = 0x9000_0000
"""Byte address of the word that says which buttons are held, and whether the ray tracer interrupts."""

BUTTON_NAMES = ("left", "right", "up", "down", "fire")
"""By bit, from bit 0 on; 1 is held."""

INTERRUPT_BIT = 8
"""Of the same word: the level of the ray tracer's interrupt."""

UART = 0x9000_0010
"""Byte address of the serial transmitter: a byte written is sent, and waits while the last one is; a read is
`UART_BUSY` while a byte is being sent."""

UART_BUSY = 1
"""The bit that a read has while a byte is being sent."""

BAUD_RATE = 115_200
"""Of the serial port: 8 data bits, no parity, a stop bit."""


def held_bits(names: Iterable[str]) -> int:
    """The word in which these buttons are held.

    Raises:
        ValueError: one of them is none of `BUTTON_NAMES`.
    """
    return sum(1 << BUTTON_NAMES.index(name) for name in set(names))


def clocks_per_bit(clock_hz: int) -> int:
    """System clocks that a bit of the serial port lasts, to the nearest."""
    return round(clock_hz / BAUD_RATE)


def c_header() -> str:
    """The same for C, and for a linker script that is preprocessed: numbers only."""
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
