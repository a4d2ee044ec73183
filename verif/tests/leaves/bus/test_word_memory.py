# SPDX-License-Identifier: MIT
"""Leaf tests of `word_memory`."""

import pytest
from vectors import any_strobe, any_word

from raycaster.hdl.signals import bits_for
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.widths import LANES


@pytest.fixture
def memory_of(leaf_of):
    """Return a function that makes a memory, whose Verilog names the program's file."""

    def made(words: int, program: str):
        leaf = leaf_of(word_memory, address=bits_for(words), words=words, program=program)
        assert f'$readmemh("{program}", memory);' in leaf.verilog[-1].read_text()
        return leaf

    return made


@pytest.mark.parametrize("words", [16, 64])
def test_word_memory(words, memory_of, tmp_path, random):
    """Reads, and writes of any lanes, at any distance."""
    model = [any_word(random) for _ in range(words)]
    program = tmp_path / "program.hex"
    program.write_text("".join(f"{word:08x}\n" for word in model))
    leaf = memory_of(words, str(program))
    # A reset in the first cycle of an access restarts it; the first read makes `word` known.
    leaf.case({"reset": 1, "access_select": 1, "strobe": 0, "address": 3}, {"access_ready": 0})
    leaf.case({"reset": 0}, {"access_ready": 0})
    leaf.case({}, {"access_ready": 1, "access_word": model[3]})
    for _ in range(20 * words):
        if random.random() < 0.3:
            idle = {"access_select": 0, "strobe": any_strobe(random), "data": any_word(random)}
            leaf.case(idle, {"access_ready": 0})
            continue
        strobe, address, data = any_strobe(random), int(random.integers(words)), any_word(random)
        access = {"access_select": 1, "strobe": strobe, "address": address, "data": data}
        leaf.case(access, {"access_ready": 0})
        mask = sum(0xFF << 8 * lane for lane in range(LANES) if strobe >> lane & 1)
        model[address] = model[address] & ~mask | data & mask
        leaf.case({}, {"access_ready": 1, "access_word": None if strobe else model[address]})
    leaf.check(settled=2)


def test_word_memory_without_a_program(memory_of):
    """Conversion needs no program file; only running the Verilog does."""
    outputs = memory_of(8, "nowhere.hex").run_myhdl([{"reset": 1}, {"reset": 0, "access_select": 1}, {}])
    assert outputs[-1] == {"access_ready": 1, "access_word": 0}
