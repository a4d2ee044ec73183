# SPDX-License-Identifier: MIT
"""Mutation testing: recordings fit, and modules whose tests catch less than before are named."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from conftest import refused

from raycaster.hdl.leaf import Cycle, Leaf
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.runs.outcomes import kept_outcome
from raycaster.verif.mutation.mutate import Leaf as LeafTest
from raycaster.verif.mutation.mutate import (
    MutationError,
    Recording,
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


def test_a_recording_that_does_not_fit_is_an_error(word, tmp_path):
    vectors = tmp_path / "recording" / "vectors.txt"
    last = vectors.read_text().split()[-1]
    vectors.write_text(vectors.read_text().removesuffix(f"{last}\n") + f"{int(last, 16) ^ 1:x}\n")
    with pytest.raises(MutationError, match="without any fault"):
        word.run(MUTANTS, 1)


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


@pytest.mark.slow
def test_the_command_reports(tmp_path, capsys, monkeypatch, names_for_digests):
    monkeypatch.chdir(tmp_path)
    assert (
        main(["--module", "ray_mem", "--mutants", "20", "--jobs", "1", "--build", "build", "--keep", "kept.json"]) == 0
    )
    assert re.search(r"ray_mem +\d+ +\d+ +\d+", capsys.readouterr().out)
    kept = kept_outcome(tmp_path / "kept.json").figures
    assert sum(kept["by_module"]["ray_mem"]) == kept["caught"] + kept["surviving"] == 20
    survivors = (tmp_path / "build" / "survivors.txt").read_text().splitlines()
    assert len(survivors) == kept["surviving"]
    assert all(line.startswith("ray_mem: ") for line in survivors)


def test_unknown_modules_are_refused():
    assert "got adder, expected one of" in refused(main, "--module", "adder")
