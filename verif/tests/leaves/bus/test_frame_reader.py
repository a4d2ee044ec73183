# SPDX-License-Identifier: MIT
"""Leaf test of `frame_reader`: frames of any length, and what is no frame between them."""

import zlib

import pytest
from vectors import any_word

from raycaster.rtl.bus.frame_check import CHECK_CYCLES
from raycaster.rtl.bus.frame_reader import frame_reader
from raycaster.serial_frames import ESCAPE, ESCAPED, FLAG, framed

ODD_WORDS = (0x7E7E_7E7E, 0x7D7D_7D7D, 0x5E5D_7D7E, 0, 0xFFFF_FFFF)


def spoilt(data: bytes, kind: int, random) -> bytes:
    """Return what is left of a frame; it ends with a flag, and is none."""
    at = int(random.integers(1, len(data) - 2))
    match kind:
        case 0:  # a wrong bit
            wrong = data[at] ^ 1 << int(random.integers(8))
            return bytes([*data[:at], wrong, *data[at + 1 :]])
        case 1:  # a lost byte
            return data[:at] + data[at + 1 :]
        case 2:  # the cable pulled
            return data[:at] + bytes([FLAG])
        case 3:  # an abort
            return data[:-1] + bytes([ESCAPE, FLAG])
        case _:  # a byte more
            return data[:at] + bytes([0x55]) + data[at:]


def wrong_checks() -> list[int]:
    """Return what a check must differ by so that the reader's state is wrong in one bit alone, for each bit."""
    rows = [(zlib.crc32((1 << bit).to_bytes(4, "little")) ^ zlib.crc32(bytes(4)), 1 << bit) for bit in range(32)]
    for bit in range(32):
        pivot = next(row for row in rows[bit:] if row[0] >> bit & 1)
        rows.remove(pivot)
        rows = [(a ^ pivot[0], b ^ pivot[1]) if a >> bit & 1 else (a, b) for a, b in rows]
        rows.insert(bit, pivot)
    return [difference for _, difference in rows]


def stuffed(plain: bytes, check: int) -> bytes:
    """Return bytes between two flags, with any check."""
    plain += check.to_bytes(4, "little")
    return b"".join(bytes([ESCAPE, one ^ ESCAPED] if one in (FLAG, ESCAPE) else [one]) for one in plain)


@pytest.mark.parametrize("places", [5, 8, 59])
def test_frame_reader(places, leaf_of, random):
    width = (places - 1).bit_length()
    leaf = leaf_of(frame_reader, data=8, words=width, place=width, shown=32, places=places)
    leaf.case({"reset": 1})
    goods = 0

    def cycle(received=0, data=None, reset=0):
        place = int(random.integers(places))
        data = random.integers(256) if data is None else data
        leaf.case({"reset": reset, "received": received, "data": data, "place": place})
        return place

    def receive(data):
        for byte in data:
            cycle(1, byte)
            for _ in range(CHECK_CYCLES - 1 + int(random.integers(2))):
                cycle()
                leaf.expect({"good": 0}, when=byte != FLAG)

    def flag(words):
        """Expect a frame or none, and read all its words; they stay as long as nothing else comes."""
        nonlocal goods
        cycle(1, FLAG)
        cycle()
        leaf.expect({"good": words is not None})
        if words is not None:
            goods += 1
            leaf.expect({"words": len(words)})
            for place, word in enumerate(words):
                leaf.case({"reset": 0, "received": 0, "data": 0, "place": place})
                leaf.case({"reset": 0, "received": 0, "data": 0, "place": 0}, {"shown": word, "words": len(words)})
        for _ in range(CHECK_CYCLES):
            cycle()
            leaf.expect({"good": 0})

    # A memory is unknown until each place has been written.
    flag(None)
    receive(framed([0] * (places - 1))[:-1])
    settled = leaf.cycle
    flag([0] * (places - 1))
    for difference in wrong_checks():
        plain = random.bytes(4)
        receive(stuffed(plain, zlib.crc32(plain) ^ difference))
        flag(None)
    for length in range(1, 8):  # no whole words, with the right check
        plain = random.bytes(length)
        receive(stuffed(plain, zlib.crc32(plain)))
        flag(None if length % 4 else [int.from_bytes(plain, "little")])
    for number in range(leaf.some(90)):
        length = int(random.integers(places)) if number % 9 else places - 1
        words = [any_word(random) if random.random() < 0.7 else int(random.choice(ODD_WORDS)) for _ in range(length)]
        if number % 7 == 3:  # too long
            receive(framed([*words, *[1] * (places - length)])[:-1])
            flag(None)
        elif number % 7 == 5:
            data = spoilt(framed([*words, 0x1234]), number // 7 % 5, random)
            if FLAG not in data[1:-1]:
                receive(data[:-1])
                flag(None)
        elif number % 7 == 6 and length:  # a reset in a frame
            # The rest is the check, as of a frame without words.
            receive(framed(words)[:-5])
            cycle(reset=1)
            receive(framed(words)[-5:-1])
            flag(None)
        else:
            receive(framed(words)[:-1])
            flag(words)
    leaf.check(settled=settled)
    assert goods > 10
