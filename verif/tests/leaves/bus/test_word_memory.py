# SPDX-License-Identifier: MIT
"""Leaf tests of `word_memory`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

from pathlib import Path

import pytest
from vectors import any_strobe, any_word, ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bits_for, unsigned
from raycaster.rtl.bus.word_memory import word_memory
from raycaster.rtl.common.interfaces import Access
from raycaster.rtl.common.widths import LANES, WORD_BITS


def mask_of(strobe: int) -> int:
    return sum(0xFF << 8 * lane for lane in range(LANES) if strobe >> lane & 1)


def memory_leaf(words: int, program: str, directory: Path) -> Leaf:
    return Leaf(word_memory, lambda: ports(
        "clk reset", access=Access(), strobe=unsigned(LANES), address=unsigned(bits_for(words)),
        data=unsigned(WORD_BITS), words=words, program=program
    ), directory)  # fmt: skip


@pytest.mark.parametrize("words", [16, 64])
def test_word_memory(words, tmp_path, random):
    model = [any_word(random) for _ in range(words)]
    program = tmp_path / "program.hex"
    program.write_text("".join(f"{word:08x}\n" for word in model))
    leaf = memory_leaf(words, str(program), tmp_path)
    assert f'$readmemh("{program}", memory);' in leaf.verilog[-1].read_text()
    # A reset in the first cycle of an access restarts it; the first read makes `word` known.
    stimulus = [{"reset": 1, "access_select": 1, "strobe": 0, "address": 3}, {"reset": 0}, {}]
    expected = {2: model[3]}
    for _ in range(20 * words):
        if random.random() < 0.3:
            stimulus.append({"access_select": 0, "strobe": any_strobe(random), "data": any_word(random)})
            continue
        strobe, address, data = any_strobe(random), int(random.integers(words)), any_word(random)
        stimulus += [{"access_select": 1, "strobe": strobe, "address": address, "data": data}, {}]
        mask = mask_of(strobe)
        model[address] = model[address] & ~mask | data & mask
        expected[len(stimulus) - 1] = None if strobe else model[address]
    outputs = leaf.run_both(stimulus, settled=2)
    for cycle, output in enumerate(outputs[2:], 2):
        assert output["access_ready"] == (cycle in expected), cycle
        if expected.get(cycle) is not None:
            assert output["access_word"] == expected[cycle], cycle


def test_word_memory_without_a_program(tmp_path):
    """Conversion needs no program file; only running the Verilog does."""
    leaf = memory_leaf(8, "nowhere.hex", tmp_path)
    assert '$readmemh("nowhere.hex", memory);' in leaf.verilog[-1].read_text()
    outputs = leaf.run_myhdl([{"reset": 1}, {"reset": 0, "access_select": 1}, {}])
    assert outputs[-1] == {"access_ready": 1, "access_word": 0}
