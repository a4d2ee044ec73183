# SPDX-License-Identifier: MIT
"""Leaf test of `frame_writer`: the bytes of frames, some of which another one cuts."""

from vectors import any_word

from raycaster.rtl.bus.frame_check import CHECK_CYCLES
from raycaster.rtl.bus.frame_writer import frame_writer
from raycaster.serial_frames import framed


def test_frame_writer(leaf_of, random):
    leaf = leaf_of(frame_writer, word=32, data=8)
    leaf.case({"reset": 1})
    for number in range(leaf.some(60)):
        odd = [0x7E7E_7E7E, 0x7D7D_7D7D, 0x007D_7E00]
        words = [any_word(random) if random.random() < 0.6 else odd[int(random.integers(3))]
                 for _ in range(1 + number % 4)]  # fmt: skip
        expected = framed(words)
        cut = int(random.integers(len(expected))) if number % 5 == 4 else len(expected)
        leaf.case({"reset": 0, "start": 1, "valid": 0, "accepted": 0, "word": 0, "last": 0})
        taken, sent, busy = 0, 0, CHECK_CYCLES
        wait = int(random.integers(3))
        while sent < cut:
            # The word that byte number `sent` belongs to.
            inside = sent > 0 and taken < len(words)
            valid = inside and wait == 0
            wait = max(0, wait - 1)
            accepted = busy == 0
            busy = max(0, busy - 1)
            word = words[taken] if valid else any_word(random)
            leaf.case({"start": 0, "valid": valid, "word": word, "last": taken == len(words) - 1 if valid else
                       random.integers(2), "accepted": accepted})  # fmt: skip
            sends = valid or not inside
            leaf.expect({"sending": sends})
            leaf.expect({"data": expected[sent]}, when=sends and accepted)
            if not (sends and accepted):
                leaf.expect({"ready": 0})
                continue
            sent, busy = sent + 1, CHECK_CYCLES + int(random.integers(3))
            # A word is accepted with its last byte.
            whole = inside and sent == 1 + plain_end(words, taken)
            leaf.expect({"ready": whole})
            if whole:
                taken, wait = taken + 1, int(random.integers(12))
        if cut == len(expected):
            leaf.case({"start": 0, "valid": 1, "word": 0, "last": 0, "accepted": 1}, {"sending": 0, "ready": 0})
    leaf.check(settled=1)


def plain_end(words, number: int) -> int:
    """Return the bytes, escaped, of the words up to this one."""
    return sum(2 if byte in (0x7D, 0x7E) else 1 for word in words[: number + 1] for byte in word.to_bytes(4, "little"))
