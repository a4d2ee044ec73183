# SPDX-License-Identifier: MIT
"""Recordings of leaf tests, which are replayed without MyHDL."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from raycaster.hdl.leaf import Cycle, Leaf
from raycaster.output import emptied

RECORD_VARIABLE = "RAYCASTER_RECORD"
"""Environment variable: the directory in which `record_test` records each run."""


def recording_name(test: str) -> str:
    """Return the name of a recording's directory: its test with parameters, without characters unsuited to paths."""
    return re.sub(r"[^\w.-]+", "-", test).strip("-")


def record(leaf: Leaf, directory: Path, stimulus: Sequence[Cycle], expected: Sequence[Cycle], settled: int) -> None:
    """Record a run of a leaf, so that it can be replayed without MyHDL.

    Args:
        leaf: the block.
        directory: replaced; gets the Verilog files, `leaf.json`, which describes them, and `vectors.txt`: one
            line per cycle, with a vector of all inputs and a vector of all outputs, the first port in the highest
            bits, in 32-bit hexadecimal words, the lowest first.
        stimulus: as for `Leaf.run_both`.
        expected: outputs of each cycle.
        settled: the first cycle from which outputs must be as expected.
    """
    emptied(directory)
    data = set()
    for module in leaf.modules:
        # Initial words of a memory are in a file of the test, which pytest removes.
        text = module.path.read_text()
        for path in re.findall(r'\$readmemh\("(.+?)"', text):
            shutil.copy(path, directory)
            data.add(Path(path).name)
            text = text.replace(path, Path(path).name)
        (directory / module.path.name).write_text(text)
    inputs, outputs = ({name: port.width for name, port in ports.items()} for ports in (leaf.inputs, leaf.outputs))
    description = {
        "module": leaf.modules[-1].name,
        "files": [module.path.name for module in leaf.modules],
        "data": sorted(data),
        "clocked": leaf.clocked,
        "inputs": inputs,
        "outputs": outputs,
        "settled": settled,
        "cycles": len(stimulus),
    }
    (directory / "leaf.json").write_text(json.dumps(description, indent=2) + "\n")
    lines = (
        f"{_split(given, sum(inputs.values()))} {_split(wanted, sum(outputs.values()))}\n"
        for given, wanted in zip(leaf.input_words(stimulus), leaf.output_words(expected), strict=True)
    )
    (directory / "vectors.txt").write_text("".join(lines))


def _split(vector: int, width: int) -> str:
    return " ".join(f"{vector >> low & 0xFFFFFFFF:x}" for low in range(0, width, 32))


def record_test(leaf: Leaf, stimulus: Sequence[Cycle], expected: Sequence[Cycle], settled: int) -> None:
    """Record a run under the name of the running test, if that is asked for; a `Leaf.recorder`."""
    # pytest sets it to "path::test[parameters] (call)".
    test = os.environ["PYTEST_CURRENT_TEST"].rpartition("::")[2].rpartition(" ")[0]
    record(leaf, Path(os.environ[RECORD_VARIABLE]) / recording_name(test), stimulus, expected, settled)
