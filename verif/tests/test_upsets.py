# SPDX-License-Identifier: MIT
"""Upsets of a running design: registers are found, a correct design recovers, and one that hangs is reported."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from unittest.mock import MagicMock

import pytest
from cocotb.handle import ArrayObject
from cocotb.types import Range
from conftest import BUILD, broken

from raycaster.configuration import configure
from raycaster.sim.job import Job
from raycaster.sim.simulator import SimulationError, build_model, convert, run_bench
from raycaster.verif.upsets.bench import KINDS, bits_of
from raycaster.verif.upsets.upsets import FLAGS, registers_of

BENCH = "raycaster.verif.upsets.bench"
SMALL = configure(engine="exact", screen="tiny", rectangles=1, reflections=0, units=4)


def test_signals_assigned_at_an_edge_are_registers():
    """Every module with a clocked process has some, memories included; comparisons are no assignments."""
    files = {file.stem: file.read_text() for file in convert(SMALL, BUILD)}
    found = registers_of(convert(SMALL, BUILD))
    assert {module for module, names in found.items() if names} == {name for name in files if "posedge" in files[name]}
    for module, names in found.items():
        declared = re.findall(r"\breg\b.*?(\w+)(?: \[\S+\])?[;,]?$", files[module], re.M)
        assert set(names) <= set(declared), module
    assert {"x", "y", "hs", "vs"} <= set(found["video_generator"])
    assert any(re.search(rf"^reg .* {name} \[", files["line_buffer"], re.M) for name in found["line_buffer"])


def run_cases(files: list[Path], directory: Path, registers: dict, cases: range) -> list[dict]:
    model = build_model(SMALL, build=BUILD, verilog=files, flags=FLAGS)
    run_bench(model, BENCH, Job(SMALL, output=str(directory), seeds=tuple(cases), registers=registers), directory)
    return read_results(directory)


def read_results(directory: Path) -> list[dict]:
    return [json.loads(line) for line in (directory / "results.jsonl").read_text().splitlines()]


@pytest.mark.slow_sets("24")
@pytest.mark.parametrize("cases", [12, 24])
def test_a_sound_design_comes_back(tmp_path: Path, cases: int):
    """After jumps of the line counter, which lose syncs, after resets and after misuse, the picture soon recovers."""
    results = run_cases(convert(SMALL, BUILD), tmp_path, {"video_generator": ("y",)}, range(cases))
    assert {result["outcome"] for result in results} <= {"StartScreen", "commit", "unseen"}
    assert Counter(result["kind"] for result in results).keys() == set(KINDS)
    flipped = [result for result in results if result["kind"] == "upset"]
    assert all(result["where"].startswith("ray_caster_renderer_i.video_generator_i.y[") for result in flipped)
    assert any(result["lost_sync"] and result["outcome"] == "StartScreen" for result in flipped)


def test_a_register_weighs_as_much_as_its_bits():
    memory = MagicMock(spec=ArrayObject, range=Range(15, "downto", 0))
    memory.__len__.return_value, memory.__getitem__.return_value = 16, [0] * 32
    assert (bits_of([0]), bits_of(memory)) == (1, 512)


@pytest.mark.slow
def test_a_design_that_hangs_is_reported(tmp_path: Path):
    """The line counter stops once an upset makes it smaller than it ever is in normal operation."""
    fault = "video_generator", "y <= y + 1;", "if (y >= -8) y <= y + 1;"
    files = broken(convert(SMALL, BUILD), tmp_path, *fault)
    with pytest.raises(SimulationError, match="did not recover in cases"):
        run_cases(files, tmp_path, {"video_generator": ("y",)}, range(24))
    assert "hangs" in {result["outcome"] for result in read_results(tmp_path)}
