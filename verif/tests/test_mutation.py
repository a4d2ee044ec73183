# SPDX-License-Identifier: MIT
"""Mutation testing works: faults are caught, and insufficient vectors are found."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from conftest import refused

from raycaster.hdl.leaf import Cycle, Leaf
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.verif.mutation.mutate import (
    Leaf as LeafTest,
)
from raycaster.verif.mutation.mutate import (
    MutationError,
    Recording,
    by_module,
    complaints,
    leaf_tests,
    leaves_of_modules,
    main,
    recordings,
)
from raycaster.verif.recording import record as record_run

MUTANTS = 30


def recorded(
    block: Any, ports: dict[str, Callable[[], Any]], stimulus: list[Cycle], directory: Path, settled: int = 0
) -> Recording:
    """Record a block, given functions that make its ports."""
    leaf = Leaf(block, lambda: {name: make() for name, make in ports.items()}, directory)
    record_run(leaf, directory / "recording", stimulus, leaf.run_myhdl(stimulus), settled)
    return Recording(directory / "recording", directory / "work")


@pytest.fixture
def word(tmp_path) -> Recording:
    """Recording of a word that is reset and then written in two cycles."""
    ports: dict[str, Callable[[], Any]] = {"clk": bit, "reset": reset_signal, "selected": bit}
    ports["bus"] = partial(SceneBus, 7)
    ports |= dict.fromkeys(("implemented", "shadow", "live"), partial(unsigned, WORD_BITS))
    written = {"reset": 0, "selected": 1, "bus_write": 1, "bus_mask": 0xFFFF, "bus_data": 0x5A5A, "implemented": 0xFFF}
    return recorded(scene_word, ports, [{"reset": 1}, written, written], tmp_path, settled=1)


@pytest.mark.slow
def test_every_operand_catches_every_fault(tmp_path):
    widths = {"remainder": 3, "digits": 2, "divisor": 3, "next_remainder": 3, "next_digits": 2}
    ports = {name: partial(unsigned, width) for name, width in widths.items()}
    operands = product(range(8), range(4), range(1, 8))
    stimulus = [dict(zip(ports, each, strict=False)) for each in operands if each[0] < each[2]]
    result = recorded(divider_step, ports, stimulus, tmp_path).run(MUTANTS, 1)
    assert by_module([result]) == {"divider_step": [25, 5]}, "five change nothing if the remainder is below the divisor"
    few = recorded(divider_step, ports, stimulus[:3], tmp_path).run(MUTANTS, 1)
    assert by_module([few])["divider_step"][1] > 10, "insufficient vectors are noticed"


def test_a_recording_that_does_not_fit_is_an_error(word, tmp_path):
    vectors = tmp_path / "recording" / "vectors.txt"
    last = vectors.read_text().split()[-1]
    vectors.write_text(vectors.read_text().removesuffix(f"{last}\n") + f"{int(last, 16) ^ 1:x}\n")
    with pytest.raises(MutationError, match="without any fault"):
        word.run(MUTANTS, 1)


# The reader passes the word to a block that reads bit 6, reads bits 1 and 2 itself, and keeps bit 4 in a register that
# nothing reads; bit 0 reaches an output that the parent leaves unconnected.
READERS = {
    "inner": "module inner(input wire [7:0] word, output wire seen); assign seen = word[6]; endmodule",
    "reader": """module reader(input wire clk, input wire [7:0] word, output wire [2:0] seen, output wire unused);
reg kept;
inner inner_i(.word(word), .seen(seen[2]));
assign seen[1:0] = word[2:1];
assign unused = word[0];
always @(posedge clk) kept <= kept ^ word[4];
endmodule""",
    "parent": """module parent(input wire clk, input wire [7:0] word, input wire turn, output wire [2:0] seen);
wire [7:0] turned = turn ? ~word : word;
reader reader_i(.clk(clk), .word(turned), .seen(seen), .unused());
endmodule""",
}


def test_bits_that_a_submodule_does_not_read_have_no_faults(tmp_path):
    directory = tmp_path / "recording"
    directory.mkdir()
    for name, text in READERS.items():
        (directory / f"{name}.v").write_text(f"{text}\n")
    vectors = [(turn << 8 | word, (word ^ -turn) & 0xFF) for turn in (0, 1) for word in range(256)]
    lines = [f"{(given & 0xFF) << 1 | given >> 8:x} {word >> 6 << 2 & 4 | word >> 1 & 3:x}" for given, word in vectors]
    (directory / "vectors.txt").write_text("\n".join(lines) + "\n")
    description = {
        "module": "parent", "files": [f"{name}.v" for name in READERS], "clocked": True,
        "data": [], "inputs": {"word": 8, "turn": 1}, "outputs": {"seen": 3}, "settled": 0, "cycles": len(lines),
    }  # fmt: skip
    (directory / "leaf.json").write_text(json.dumps(description))
    mutants = Recording(directory, tmp_path / "work").run(1000, 1).mutants
    assert [mutant.selector for mutant in mutants] == list(range(1, len(mutants) + 1))
    planted = {mutant.port for mutant in mutants if mutant.kind == "reader_i" and mutant.port.startswith("word")}
    assert planted == {f"word[{place}]" for place in (0, 1, 2, 6)}
    # A fault in the parent that reaches only an unread bit changes nothing.
    caught = {(mutant.kind, mutant.port): mutant.caught >= 0 for mutant in mutants if mutant.mode == "inv"}
    assert [caught["ternary", f"Y[{place}]"] for place in range(8)] == [False, True, True, *[False] * 3, True, False]
    assert all(mutant.at.endswith("turn ? ~word : word") for mutant in mutants if mutant.kind == "ternary")
    # If fewer faults are requested than exist, exactly that many are planted, although some were dropped.
    assert len(Recording(directory, tmp_path / "few").plant(40, 1)) == 40


def test_complaints():
    """A module may catch a little less than before, but not much; a new one has no share to be compared with."""
    before = {"adder": [90, 10], "divider": [100, 0]}
    assert complaints({"adder": [88, 12], "divider": [97, 3], "new": [0, 10]}, before) == []
    assert complaints({"adder": [87, 13], "divider": [97, 3]}, before) == [
        "adder: 87.0% of the mutants are caught, 90.0% before"
    ]


def test_every_block_has_recordings():
    """Each block that is mutated has its test, with the given parameter sets."""
    known, tests = leaves_of_modules(), leaf_tests()
    assert {*recordings(known, tests).values()} == {*known}
    with pytest.raises(MutationError, match=r"divider: expected sets \['F9'\] of test_divider, got \[\]"):
        recordings({"divider": LeafTest("test_divider", ["F9"])}, tests)


@pytest.mark.parametrize("text", ["[sets]\nadder = []", "[should_be]\ndivider = 1", '[left_out]\nlamp = "no block"'])
def test_a_data_file_with_an_unknown_name_is_an_error(text, tmp_path: Path):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(MutationError, match="there is no such block or key"):
        leaves_of_modules(path)


@pytest.mark.slow
def test_the_command_reports(tmp_path, capsys, monkeypatch, names_for_digests):
    monkeypatch.chdir(tmp_path)
    assert (
        main(["--module", "ray_mem", "--mutants", "20", "--jobs", "1", "--build", "build", "--keep", "kept.json"]) == 0
    )
    assert re.search(r"ray_mem +\d+ +\d+ +\d+", capsys.readouterr().out)
    kept = json.loads((tmp_path / "kept.json").read_text())["figures"]
    assert sum(kept["by_module"]["ray_mem"]) == kept["caught"] + kept["surviving"] == 20
    survivors = (tmp_path / "build" / "survivors.txt").read_text().splitlines()
    assert len(survivors) == kept["surviving"]
    assert all(line.startswith("ray_mem: ") for line in survivors)


def test_unknown_modules_are_refused():
    assert "got adder, expected one of" in refused(main, "--module", "adder")
