# SPDX-License-Identifier: MIT
"""Leaf tests of `word_memory`: MyHDL and converted Verilog match the expected values on the same vectors."""

from pathlib import Path

import pytest
from vectors import any_strobe, any_word, check, leaf_of

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bits_for
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.widths import LANES, WORD_BITS


def memory_leaf(words: int, program: str, directory: Path) -> Leaf:
    """Make a memory; its Verilog names the program's file."""
    widths = {"address": bits_for(words), "data": WORD_BITS}
    leaf = leaf_of(word_memory, directory, **widths, words=words, program=program)
    assert f'$readmemh("{program}", memory);' in leaf.verilog[-1].read_text()
    return leaf


@pytest.mark.parametrize("words", [16, 64])
def test_word_memory(words, tmp_path, random):
    """Reads, and writes of any lanes, at any distance."""
    model = [any_word(random) for _ in range(words)]
    program = tmp_path / "program.hex"
    program.write_text("".join(f"{word:08x}\n" for word in model))
    # A reset in the first cycle of an access restarts it; the first read makes `word` known.
    stimulus = [{"reset": 1, "access_select": 1, "strobe": 0, "address": 3}, {"reset": 0}, {}]
    answers = {2: {"access_ready": 1, "access_word": model[3]}}
    for _ in range(20 * words):
        if random.random() < 0.3:
            stimulus.append({"access_select": 0, "strobe": any_strobe(random), "data": any_word(random)})
            continue
        strobe, address, data = any_strobe(random), int(random.integers(words)), any_word(random)
        stimulus += [{"access_select": 1, "strobe": strobe, "address": address, "data": data}, {}]
        mask = sum(0xFF << 8 * lane for lane in range(LANES) if strobe >> lane & 1)
        model[address] = model[address] & ~mask | data & mask
        answers[len(stimulus) - 1] = {"access_ready": 1, "access_word": None if strobe else model[address]}
    expected = [answers.get(cycle, {"access_ready": 0}) for cycle in range(len(stimulus))]
    check(memory_leaf(words, str(program), tmp_path), stimulus, expected, settled=2)


def test_word_memory_without_a_program(tmp_path):
    """Conversion needs no program file; only running the Verilog does."""
    outputs = memory_leaf(8, "nowhere.hex", tmp_path).run_myhdl([{"reset": 1}, {"reset": 0, "access_select": 1}, {}])
    assert outputs[-1] == {"access_ready": 1, "access_word": 0}
