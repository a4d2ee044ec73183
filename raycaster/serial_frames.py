# SPDX-License-Identifier: MIT
"""Frames on a serial line to a design with the bus uart: how a host writes and reads registers.

A frame is made of 32-bit words, lowest byte first. The last one is the CRC-32 of the others, as in zip files. A byte
that would be `FLAG` or `ESCAPE` is sent as `ESCAPE` and the byte with `ESCAPED` inverted, and a `FLAG` is before and
after each frame. So a flag ends whatever came before it, be it noise or half a frame.

A frame to the design has any number of accesses. Each begins with a word: its word address, its number of words, and
whether it writes; a write is followed by its words. A read must be the last. The answer has the first word of the
last access, and the words that it read.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator, Sequence

FLAG, ESCAPE, ESCAPED = 0x7E, 0x7D, 0x20

LEAD = 0xFF
"""Byte before a host's frame: it has no falling edge but that of its start bit, so after it a receiver that was in the
middle of a byte, of noise or of another host, finds the start bit of the next one."""

ADDRESS_BITS, COUNT_BITS, WRITE_BIT = 16, 10, 31
"""First word of an access: the address from bit 0 on, the number of words above it, and in this bit 1 for a write."""

WORD_BYTES = 4


def access(address: int, words: Sequence[int] = (), *, read: int = 0) -> list[int]:
    """Return the words of an access: a write of some words from a word address on, or a read of `read` words."""
    count = len(words) or read
    if count >> COUNT_BITS or address >> ADDRESS_BITS:
        raise ValueError(f"an access to {address} of {count} words does not fit a frame")
    return [int(bool(words)) << WRITE_BIT | count << ADDRESS_BITS | address, *words]


def writes(pairs: Iterable[tuple[int, int]]) -> list[int]:
    """Return the accesses that write words to addresses; the last pair, which commits, is written last."""
    *scene, commit = pairs
    runs: list[tuple[int, list[int]]] = []
    for address, word in sorted(dict(scene).items()):
        if not runs or address != runs[-1][0] + len(runs[-1][1]):
            runs.append((address, []))
        runs[-1][1].append(word)
    return [word for address, words in (*runs, (commit[0], [commit[1]])) for word in access(address, words)]


def count_of(first: int) -> int:
    """Return an access's number of words, from its first word."""
    return (first >> ADDRESS_BITS) % (1 << COUNT_BITS)


def last_access(words: Sequence[int]) -> int:
    """Return the first word of a frame's last access, with which the answer begins."""
    at = 0
    while True:
        first = words[at]
        at += 1 + count_of(first)
        if not first >> WRITE_BIT or at >= len(words):
            return first


def framed(words: Sequence[int]) -> bytes:
    """Return the bytes of a frame, from its first flag to its last one."""
    plain = b"".join(word.to_bytes(WORD_BYTES, "little") for word in words)
    plain += zlib.crc32(plain).to_bytes(WORD_BYTES, "little")
    sent = bytearray([FLAG])
    for byte in plain:
        sent += bytes([ESCAPE, byte ^ ESCAPED]) if byte in (FLAG, ESCAPE) else bytes([byte])
    return bytes([*sent, FLAG])


class FrameDecoder:
    """Finds the frames in bytes that come in parts of any size."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def feed(self, data: bytes) -> Iterator[list[int]]:
        """Yield the words of each whole frame whose check is right, and drop everything else."""
        for byte in data:
            if byte != FLAG:
                self._bytes.append(byte)
                continue
            held, self._bytes = bytes(self._bytes), bytearray()
            plain, escaped = bytearray(), 0
            for one in held:
                if one != ESCAPE:
                    plain.append(one ^ escaped)
                escaped = ESCAPED if one == ESCAPE else 0
            words = [int.from_bytes(plain[at : at + WORD_BYTES], "little") for at in range(0, len(plain), WORD_BYTES)]
            whole = words and not escaped and len(plain) % WORD_BYTES == 0
            if whole and zlib.crc32(plain[:-WORD_BYTES]) == words[-1]:
                yield words[:-1]
