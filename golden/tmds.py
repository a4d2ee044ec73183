# SPDX-License-Identifier: MIT
"""TMDS, the code of a DVI link's channels: bytes and control bits to symbols of ten bits, and back (DVI 1.0, 3.2).

A symbol's bit 0 is sent first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

CONTROL_SYMBOLS = (0b1101010100, 0b0010101011, 0b0101010100, 0b1010101011)
"""Symbols sent in blanking, by the control bits c1 c0."""


class Sample(NamedTuple):
    """Content of a channel in one pixel: a byte in the picture, two bits in blanking."""

    visible: bool
    data: int
    control: int


def minimise_transitions(data: int) -> int:
    """Do the first step of encoding: nine bits, the highest 1 if the byte was chained by XOR, 0 if by XNOR."""
    ones = data.bit_count()
    xnor = int(ones > 4 or (ones == 4 and not data & 1))
    word = data & 1
    for index in range(1, 8):
        word |= ((word >> index - 1 ^ data >> index ^ xnor) & 1) << index
    return word | (1 - xnor) << 8


def encode(samples: Iterable[Sample]) -> Iterator[int]:
    """Yield the symbols of a channel, starting with zero disparity."""
    disparity = 0  # ones minus zeros sent since blanking
    for visible, data, control in samples:
        if not visible:
            disparity = 0
            yield CONTROL_SYMBOLS[control]
            continue
        word = minimise_transitions(data)
        chained, low = word >> 8, word & 0xFF
        excess = 2 * low.bit_count() - 8
        invert = 1 - chained if 0 in (disparity, excess) else int((disparity > 0) == (excess > 0))
        symbol = invert << 9 | chained << 8 | (low ^ 0xFF if invert else low)
        disparity += 2 * symbol.bit_count() - 10
        yield symbol


def decode(symbol: int) -> Sample:
    """Return the content of a symbol.

    Raises:
        ValueError: no content has this symbol.
    """
    if symbol in CONTROL_SYMBOLS:
        return Sample(False, 0, CONTROL_SYMBOLS.index(symbol))
    chained, word = symbol >> 8 & 1, symbol & 0xFF
    if symbol >> 9:
        word ^= 0xFF
    steps = word ^ word << 1
    data = (steps if chained else steps ^ 0xFE) & 0xFF
    if minimise_transitions(data) != chained << 8 | word:
        raise ValueError(f"{symbol:010b} is not a TMDS symbol")
    return Sample(True, data, 0)
