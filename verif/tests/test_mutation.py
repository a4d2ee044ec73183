# SPDX-License-Identifier: MIT
"""Mutation testing works: faults are caught, proved equivalent or explained, and insufficient vectors are found."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from itertools import product

import pytest
from conftest import SMALL_SCENE

from raycaster.buses import BRIDGED
from raycaster.configuration import configure
from raycaster.convert.write import write_dvi_encoder, write_scene_system, write_system, write_verilog
from raycaster.engines import ENGINES
from raycaster.errors import UserError
from raycaster.fit.fixing import fix
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.scene import load_scene
from raycaster.verif.formal.prover import missing_tools
from raycaster.verif.mutation.mutate import (
    LEAST_CAUGHT,
    Expectation,
    Explanation,
    Mutant,
    MutationError,
    Recording,
    Result,
    complaints,
    count_outcomes,
    expectations,
    main,
    share_caught,
)
from raycaster.verif.recording import record as record_run

pytestmark = pytest.mark.skipif(bool(missing_tools()), reason=f"not installed: {', '.join(missing_tools())}")

WIDTH, COUNT = 3, 2
MUTANTS = 30


@pytest.fixture
def recorded(tmp_path):
    """Return a function that records a divider step, optionally with changed expectations."""

    def record(remainders, change=dict) -> Recording:
        ports = {"remainder": WIDTH, "digits": COUNT, "divisor": WIDTH, "next_remainder": WIDTH, "next_digits": COUNT}
        (tmp_path / "verilog").mkdir()
        leaf = Leaf(
            divider_step, lambda: {name: unsigned(width) for name, width in ports.items()}, tmp_path / "verilog"
        )
        stimulus = [
            {"remainder": remainder, "digits": digits, "divisor": divisor}
            for divisor in range(1, 1 << WIDTH)
            for remainder in remainders
            if remainder < divisor
            for digits in range(1 << COUNT)
        ]
        record_run(leaf, tmp_path / "recording", stimulus, [change(cycle) for cycle in leaf.run_myhdl(stimulus)], 0)
        return Recording(tmp_path / "recording", tmp_path / "work")

    return record


def outcomes(result: Result) -> dict[str, int]:
    return count_outcomes(result.mutants)


@pytest.mark.slow
def test_every_operand_catches_every_fault(recorded):
    contract = Expectation((), assumptions={"remainder < divisor": "the division's invariant"})
    result = recorded(range(1 << WIDTH)).run(MUTANTS, 1, contract)
    counts = outcomes(result)
    assert sum(counts.values()) == MUTANTS
    assert counts["surviving"] == counts["explained"] == 0, [str(mutant) for mutant in result.mutants]
    assert share_caught(counts) == 1.0


def test_one_operand_leaves_survivors(recorded):
    result = recorded([0]).run(MUTANTS, 1, Expectation(()))
    survivors = [mutant for mutant in result.mutants if mutant.outcome == "surviving"]
    assert survivors
    assert share_caught(outcomes(result)) < 1
    assert any("remainder" in mutant.at for mutant in survivors), [str(mutant) for mutant in survivors]


def test_a_recording_that_does_not_fit_is_an_error(recorded):
    def wrong(cycle):
        return {**cycle, "next_digits": cycle["next_digits"] ^ 1}

    with pytest.raises(MutationError, match="without any fault"):
        recorded([0], wrong).run(MUTANTS, 1, Expectation(()))


def word_recording(tmp_path, cycles: int) -> Recording:
    """Record a word that is reset and then written in each cycle."""
    (tmp_path / "verilog").mkdir()
    leaf = Leaf(
        scene_word,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            "bus": SceneBus(7),
            "selected": bit(),
            "implemented": unsigned(WORD_BITS),
            "shadow": unsigned(WORD_BITS),
            "live": unsigned(WORD_BITS),
        },
        tmp_path / "verilog",
    )
    written = {"reset": 0, "selected": 1, "bus_write": 1, "bus_mask": 0xFFFF, "bus_data": 0x5A5A, "implemented": 0xFFF}
    stimulus = [{"reset": 1}] + [written] * cycles
    record_run(leaf, tmp_path / "recording", stimulus, leaf.run_myhdl(stimulus), 1)
    return Recording(tmp_path / "recording", tmp_path / "work")


@pytest.mark.parametrize(
    ("expectation", "complaint"),
    [
        (Expectation((), invariants=("shadow != 5",)), "does not follow from the cycle before"),
        (Expectation((), invariants=("shadow != 0",)), "does not follow from reset"),
        (Expectation((), assumptions={"no_such == 1": ""}), "no_such"),
    ],
)
def test_a_contract_that_does_not_hold_is_an_error(expectation, complaint, tmp_path):
    with pytest.raises(UserError, match=complaint):
        word_recording(tmp_path, 2).run(MUTANTS, 1, expectation)


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
    recording = Recording(directory, tmp_path / "work")
    result = recording.run(1000, 1, Expectation(()))
    assert [mutant.selector for mutant in result.mutants] == list(range(1, len(result.mutants) + 1))
    planted = {mutant.port for mutant in result.mutants if mutant.kind == "reader_i" and mutant.port.startswith("word")}
    assert planted == {f"word[{place}]" for place in (0, 1, 2, 6)}
    # A fault in the parent that reaches only an unread bit is equivalent.
    fates = {(mutant.kind, mutant.port): mutant.outcome for mutant in result.mutants if mutant.mode == "inv"}
    assert [fates["ternary", f"Y[{place}]"] for place in (0, 1, 2, 6)] == ["surviving", "caught", "caught", "caught"]
    assert [fates["ternary", f"Y[{place}]"] for place in (3, 4, 5, 7)] == ["equivalent"] * 4
    # If fewer faults are requested than exist, exactly that many are planted, although some were dropped.
    assert len(Recording(directory, tmp_path / "few").plant(40, 1)) == 40


def test_explanations(tmp_path):
    needed, stale = Explanation("anything"), Explanation("nothing", kind="none")
    expectation = Expectation((), explained=(stale, needed))
    result = word_recording(tmp_path, 2).run(MUTANTS, 1, expectation)
    counts = outcomes(result)
    assert counts["explained"] and not counts["surviving"]
    assert share_caught(counts) < LEAST_CAUGHT, "explained faults do not count as caught"
    few, unneeded = complaints([result], {"scene_word": expectation})
    assert "fewer than 97%" in few and str(stale) in unneeded


def test_an_explanation_fits_what_it_names():
    mutant = Mutant(1, "inv", "and", "A[3]", "pending", "")
    for fitting in ({}, {"at": "pending"}, {"port": "A"}, {"port": "A[3]", "mode": "inv"}, {"kind": "and"}):
        assert Explanation("", **fitting).fits(mutant)
    for other in ({"at": "live"}, {"port": "A[4]"}, {"port": "A", "mode": "const0"}, {"kind": "or"}):
        assert not Explanation("", **other).fits(mutant)


@pytest.mark.slow
def test_every_module_is_mutated(tmp_path):
    scene = load_scene(SMALL_SCENE)
    files = []
    for engine, rich in product(ENGINES, (True, False)):
        looks = dict.fromkeys(ENGINES[engine].looks, rich)
        config = configure(engine=engine, units=1, rectangles=5, reflections=2, allow_underrun=True, **looks)
        files += write_scene_system(config, scene, tmp_path / config.name)
    files += write_system(config, tmp_path / "processor")
    for bus in BRIDGED:
        files += write_verilog(replace(config, bus=bus), tmp_path / bus)
    files += write_verilog(configure(engine="beam", pixels=2, reflections=1), tmp_path / "lanes")
    files += write_verilog(fix(SMALL_SCENE, {"engine": "exact"}, "rects").design.configuration, tmp_path / "fixed")
    files += write_dvi_encoder(config, tmp_path / "dvi")
    known = expectations()
    # The scene system's scene is fixed at generation, so its leaf test cannot vary its bus traffic. In the system with
    # a processor a program determines the traffic, and PicoRV32 is given Verilog. The pixel clock is the clock itself,
    # at whose edges a replay compares, and a gated clock has no value per cycle. word_of is only a wire, and by_axis is
    # one line, whose outputs are disturbed in each block that instantiates it.
    unmutated = {
        "scene_system", "ray_caster_system", "processor_host", "picorv32", "pixel_clock", "clock_gate", "word_of",
        "by_axis",
    }  # fmt: skip
    # Further sizes of a block have a numeric suffix.
    assert set(known) == {re.sub(r"_\d+$", "", path.stem) for path in files} - unmutated
    assert all(expectation.tests for expectation in known.values())
    assert all(entry.why for expectation in known.values() for entry in expectation.explained)


def test_a_data_file_with_an_unknown_key_is_an_error(tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text("[divider]\nshould_be = 1\n")
    with pytest.raises(MutationError, match="should_be"):
        expectations(path)


@pytest.mark.slow
def test_the_command_reports(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["--module", "ray_mem", "--mutants", "20", "--jobs", "1", "--build", "build"]) == 0
    assert re.search(r"ray_mem +20 +\d+", capsys.readouterr().out)
    [result] = json.loads((tmp_path / "build" / "results.json").read_text())
    assert result["module"] == "ray_mem" and len(result["mutants"]) == 20


@pytest.mark.parametrize("arguments", [["--module", "adder"]])
def test_unknown_modules_are_refused(arguments):
    with pytest.raises(UserError, match="got adder, expected one of"):
        main(arguments)
