# SPDX-License-Identifier: MIT
"""Mutation testing works: faults are caught, proved equivalent or explained, and insufficient vectors are found."""

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

from raycaster.errors import UserError
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.verif.mutation.mutate import (
    LEAST_CAUGHT,
    Expectation,
    MutationError,
    Recording,
    complaints,
    count_outcomes,
    expectations,
    fits,
    leaf_tests,
    main,
    recordings,
    share_caught,
)
from raycaster.verif.recording import record as record_run

WIDTH, COUNT = 3, 2
MUTANTS = 30


@pytest.fixture
def recorded(tmp_path):
    """Return a function that records a divider step, optionally with changed expectations."""

    def record(remainders, change=dict) -> Recording:
        ports = {"remainder": WIDTH, "digits": COUNT, "divisor": WIDTH, "next_remainder": WIDTH, "next_digits": COUNT}
        leaf = Leaf(divider_step, lambda: {name: unsigned(width) for name, width in ports.items()}, tmp_path)
        operands = product(remainders, range(1 << COUNT), range(1, 1 << WIDTH))
        stimulus = [dict(zip(ports, each, strict=False)) for each in operands if each[0] < each[2]]
        record_run(leaf, tmp_path / "recording", stimulus, [change(cycle) for cycle in leaf.run_myhdl(stimulus)], 0)
        return Recording(tmp_path / "recording", tmp_path / "work")

    return record


@pytest.fixture
def word(tmp_path) -> Recording:
    """Recording of a word that is reset and then written in two cycles."""
    ports: dict[str, Callable[[], Any]] = {"clk": bit, "reset": reset_signal, "selected": bit}
    ports["bus"] = partial(SceneBus, 7)
    ports |= dict.fromkeys(("implemented", "shadow", "live"), partial(unsigned, WORD_BITS))
    leaf = Leaf(scene_word, lambda: {name: make() for name, make in ports.items()}, tmp_path)
    written = {"reset": 0, "selected": 1, "bus_write": 1, "bus_mask": 0xFFFF, "bus_data": 0x5A5A, "implemented": 0xFFF}
    stimulus = [{"reset": 1}, written, written]
    record_run(leaf, tmp_path / "recording", stimulus, leaf.run_myhdl(stimulus), 1)
    return Recording(tmp_path / "recording", tmp_path / "work")


@pytest.mark.slow
def test_every_operand_catches_every_fault(recorded):
    contract = Expectation(assumptions={"remainder < divisor": "the division's invariant"})
    result = recorded(range(1 << WIDTH)).run(MUTANTS, 1, contract)
    assert len(result.mutants) == MUTANTS
    assert share_caught([result]) == 1


def test_one_operand_leaves_survivors(recorded):
    result = recorded([0]).run(MUTANTS, 1, Expectation())
    assert any("remainder" in mutant.at for mutant in result.mutants if mutant.outcome == "surviving")
    assert share_caught([result]) < 1


def test_a_recording_that_does_not_fit_is_an_error(recorded):
    wrong = recorded([0], lambda cycle: {**cycle, "next_digits": cycle["next_digits"] ^ 1})
    with pytest.raises(MutationError, match="without any fault"):
        wrong.run(MUTANTS, 1, Expectation())


@pytest.mark.parametrize(
    ("expectation", "complaint"),
    [
        (Expectation(invariants=["shadow != 5"]), "does not follow from the cycle before"),
        (Expectation(invariants=["shadow != 0"]), "does not follow from reset"),
        (Expectation(assumptions={"no_such == 1": ""}), "no_such"),
    ],
)
def test_a_contract_that_does_not_hold_is_an_error(expectation, complaint, word):
    with pytest.raises(UserError, match=complaint):
        word.run(MUTANTS, 1, expectation)


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
    mutants = Recording(directory, tmp_path / "work").run(1000, 1, Expectation()).mutants
    assert [mutant.selector for mutant in mutants] == list(range(1, len(mutants) + 1))
    planted = {mutant.port for mutant in mutants if mutant.kind == "reader_i" and mutant.port.startswith("word")}
    assert planted == {f"word[{place}]" for place in (0, 1, 2, 6)}
    # A fault in the parent that reaches only an unread bit is equivalent.
    fates = {(mutant.kind, mutant.port): mutant.outcome for mutant in mutants if mutant.mode == "inv"}
    assert [fates["ternary", f"Y[{place}]"] for place in (0, 1, 2, 6)] == ["surviving", "caught", "caught", "caught"]
    assert [fates["ternary", f"Y[{place}]"] for place in (3, 4, 5, 7)] == ["equivalent"] * 4
    # If fewer faults are requested than exist, exactly that many are planted, although some were dropped.
    assert len(Recording(directory, tmp_path / "few").plant(40, 1)) == 40


def test_explanations(word):
    expectation = Expectation(explained={"* none *": "nothing", "*": "anything"})
    result = word.run(MUTANTS, 1, expectation)
    counts = count_outcomes([result])
    assert counts["explained"] and not counts["surviving"]
    assert share_caught([result]) < LEAST_CAUGHT, "explained faults do not count as caught"
    few, unneeded = complaints([result], {"scene_word": expectation})
    assert "fewer than 97%" in few and "* none *" in unneeded


def test_a_pattern_is_of_the_whole_text():
    text = "inv and A[3] at `pending`"
    assert all(fits(pattern, text) for pattern in ("*", text, "* at `pending`", "inv * A[*] *"))
    assert not any(fits(pattern, text) for pattern in ("* at `live`", "inv and A[4] *", "const0 *", "inv and A[3]"))


def test_every_block_has_recordings():
    """Each block that is mutated has its test, with the given parameter sets; each survivor has its reason."""
    known, tests = expectations(), leaf_tests()
    assert {*recordings(known, tests).values()} == {*known}
    assert all(why for expectation in known.values() for why in expectation.explained.values())
    with pytest.raises(MutationError, match=r"divider: expected sets \['F9'\] of test_divider, got \[\]"):
        recordings({"divider": Expectation("test_divider", sets=["F9"])}, tests)


@pytest.mark.parametrize("text", ["[sets]\nadder = []", "[should_be]\ndivider = 1", '[left_out]\nlamp = "no block"'])
def test_a_data_file_with_an_unknown_name_is_an_error(text, tmp_path: Path):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(MutationError, match="there is no such block or key"):
        expectations(path)


@pytest.mark.slow
def test_the_command_reports(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["--module", "ray_mem", "--mutants", "20", "--jobs", "1", "--build", "build"]) == 0
    assert re.search(r"ray_mem +20 +\d+", capsys.readouterr().out)
    [result] = json.loads((tmp_path / "build" / "results.json").read_text())
    assert result["module"] == "ray_mem" and len(result["mutants"]) == 20


def test_unknown_modules_are_refused():
    assert "got adder, expected one of" in refused(main, "--module", "adder")
