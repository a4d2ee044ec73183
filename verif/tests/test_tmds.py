# SPDX-License-Identifier: MIT
"""Golden model of TMDS."""

from __future__ import annotations

from collections import deque

from raycaster.golden.tmds import CONTROL_SYMBOLS, Sample, decode, encode, minimise_transitions
from raycaster.rtl.dvi.tmds_encoder import DISPARITY_BITS, SYMBOL_BITS


def test_every_byte_at_every_disparity_decodes():
    """All symbols that can be sent are found by sending every byte at every disparity that is reached."""
    found, reached, todo = set(), {0: ()}, deque([0])
    while todo:
        path = reached[todo.popleft()]
        for data in range(256):
            *_, symbol = encode(Sample(True, byte, 0) for byte in (*path, data))
            assert decode(symbol) == Sample(True, data, 0)
            found.add(symbol)
            balance = sum(2 * one.bit_count() - 10 for one in encode(Sample(True, byte, 0) for byte in (*path, data)))
            if balance not in reached:
                reached[balance] = (*path, data)
                todo.append(balance)
    assert set(reached) == set(range(-8, 9, 2))
    # Half the disparity plus half a word's excess, which is at most 4, must fit.
    assert max(reached) // 2 + 4 < 1 << DISPARITY_BITS - 1
    assert len(found) == 460
    assert not found & set(CONTROL_SYMBOLS)
    refused = 0
    for symbol in set(range(1 << SYMBOL_BITS)) - set(CONTROL_SYMBOLS):
        try:
            decode(symbol)
        except ValueError:
            refused += 1
            assert symbol not in found
    # Only each byte's word and its complement are accepted.
    assert refused == (1 << SYMBOL_BITS) - len(CONTROL_SYMBOLS) - 512


def test_known_symbols():
    """From a balanced start, XOR keeps all zeros and XNOR keeps all ones."""
    assert list(encode([Sample(True, 0, 0)] * 3)) == [0b0100000000, 0b1111111111, 0b0100000000]
    assert list(encode([Sample(True, 255, 0)] * 3)) == [0b1000000000, 0b0011111111, 0b0011111111]
    assert [decode(symbol).control for symbol in CONTROL_SYMBOLS] == [0, 1, 2, 3]


def test_transitions_are_few():
    for data in range(256):
        low = minimise_transitions(data) & 0xFF
        assert (low ^ low >> 1 & 0x7F).bit_count() - (low >> 7) <= 4
