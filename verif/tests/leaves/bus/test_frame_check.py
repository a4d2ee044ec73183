# SPDX-License-Identifier: MIT
"""Leaf test of `frame_check`: the CRC-32 of Python's zlib."""

import zlib

from raycaster.rtl.bus.frame_check import CHECK_CYCLES, RESIDUE, frame_check


def test_frame_check(leaf_of, random):
    leaf = leaf_of(frame_check, data=8, state=32)
    for number in range(30):
        data = bytes(int(byte) for byte in random.integers(256, size=number % 7))
        if number % 2:
            data += zlib.crc32(data).to_bytes(4, "little")
        leaf.case({"clear": 1, "add": random.integers(2), "data": random.integers(256)})
        for length in range(len(data) + 1):
            said = {"state": zlib.crc32(data[:length]) ^ 0xFFFFFFFF}
            for _ in range(random.integers(3)):
                leaf.case({"clear": 0, "add": 0, "data": random.integers(256)}, said)
            if length < len(data):
                leaf.case({"clear": 0, "add": 1, "data": data[length]}, said)
                for _ in range(CHECK_CYCLES - 1):
                    leaf.case({"clear": 0, "add": 0, "data": random.integers(256)})
        if number % 2:
            leaf.case({"clear": 0, "add": 0, "data": 0}, {"state": RESIDUE})
    leaf.check(settled=1)
