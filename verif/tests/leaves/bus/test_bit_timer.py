# SPDX-License-Identifier: MIT
"""Leaf test of `bit_timer`: each mark is within a cycle of its time, at a rate that is right within 0.2 per cent."""

import pytest

from raycaster.rtl.bus.bit_timer import bit_timer


@pytest.mark.parametrize("middle", [True, False])
@pytest.mark.parametrize("baud", [9_600, 115_200, 1_000_000, 3_000_000, 3_562_500])
def test_bit_timer(baud, middle, leaf_of, random):
    clock_hz, bits = 25_000_000, 10
    cycles = clock_hz / baud
    leaf = leaf_of(bit_timer, clock_hz=clock_hz, baud=baud, middle=middle)
    begins = []
    for _ in range(2 if cycles > 1000 else 4):
        begins.append(leaf.cycle)
        leaf.case({"restart": 1})
        for _ in range(int((bits + random.random()) * cycles)):
            leaf.case({"restart": 0})
    outputs = leaf.check(settled=1)
    for begin, end in zip(begins, [*begins[1:], leaf.cycle], strict=True):
        marks = [cycle for cycle in range(begin + 1, end) if outputs[cycle]["tick"]]
        assert len(marks) >= bits
        for number, mark in enumerate(marks[:bits]):
            # A sender's bit ends after cycle `mark`; a receiver's byte began up to a cycle before it was seen.
            ideal = (number + 0.5) * cycles - 0.5 if middle else (number + 1) * cycles
            off, rounded = mark - begin - ideal, 0.002 * ideal + 0.1
            least, most = (-0.5, 0.5) if middle else (0, 1)
            assert least - rounded < off < most + rounded, (number, off)
