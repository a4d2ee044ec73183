# SPDX-License-Identifier: MIT
"""Golden model of TMDS."""

from __future__ import annotations

from contextlib import suppress

from raycaster.golden.tmds import CONTROL_SYMBOLS, Sample, decode, encode
from raycaster.rtl.dvi.tmds_encoder import DISPARITY_BITS, SYMBOL_BITS


def test_every_byte_at_every_disparity_decodes():
    """All symbols that can be sent are found by sending every byte at every disparity that is reached."""
    found, reached, paths = set(), {0}, [()]
    for path in paths:
        for data in range(256):
            symbols = list(encode(Sample(True, byte, 0) for byte in (*path, data)))
            assert decode(symbols[-1]) == Sample(True, data, 0)
            found.add(symbols[-1])
            balance = sum(2 * symbol.bit_count() - 10 for symbol in symbols)
            if balance not in reached:
                reached.add(balance)
                paths.append((*path, data))
    assert reached == set(range(-8, 9, 2))
    # Half the disparity plus half a word's excess, which is at most 4, must fit.
    assert max(reached) // 2 + 4 < 1 << DISPARITY_BITS - 1
    # Fewer if any byte were chained with more transitions than it needs.
    assert len(found) == 460
    decoded = []
    for symbol in range(1 << SYMBOL_BITS):
        with suppress(ValueError):
            decoded.append(decode(symbol))
    # Only each byte's word and its complement are accepted.
    assert len(decoded) == 512 + len(CONTROL_SYMBOLS)


def test_known_symbols():
    """From a balanced start, XOR keeps all zeros and XNOR keeps all ones; of four ones, bit 0 decides."""
    assert list(encode([Sample(True, 0, 0)] * 3)) == [0b0100000000, 0b1111111111, 0b0100000000]
    assert list(encode([Sample(True, 255, 0)] * 3)) == [0b1000000000, 0b0011111111, 0b0011111111]
    assert [*encode([Sample(True, 0x0F, 0)]), *encode([Sample(True, 0xF0, 0)])] == [0b0100000101, 0b1000000101]
    assert [decode(symbol).control for symbol in CONTROL_SYMBOLS] == [0, 1, 2, 3]
