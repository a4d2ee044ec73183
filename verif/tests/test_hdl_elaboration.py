# SPDX-License-Identifier: MIT
"""Elaboration leaves MyHDL and Python as they were, and one version of MyHDL is used."""

import importlib.metadata
import inspect
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from conftest import ROOT
from hdl_blocks import converted, everything, everything_arguments, swap
from test_project import MAY_IMPORT

from raycaster.hdl.elaboration import _DEEPEST, elaboration
from raycaster.hdl.internals import all_signals
from raycaster.hdl.signals import bit


def test_elaboration_leaves_nothing_behind():
    before = inspect.stack
    slow = [(frame[0], frame[3]) for frame in inspect.stack()][:_DEEPEST]
    lines, file = inspect.getsourcelines(swap.func), inspect.getsourcefile(swap.func)
    known = len(all_signals)
    with elaboration():
        assert inspect.stack is not before
        # MyHDL reads these parts of a frame.
        assert [(frame[0], frame[3]) for frame in inspect.stack()] == slow
        assert [(frame[0], frame[3]) for frame in inspect.getouterframes(inspect.currentframe())] == slow
        for _ in range(2):
            assert (inspect.getsourcelines(swap.func), inspect.getsourcefile(swap.func)) == (lines, file)
        signal = bit()
        assert all_signals[-1] is signal
    assert inspect.stack is before
    assert len(all_signals) == known


def test_two_threads_convert_as_one_after_the_other(tmp_path):
    """Two threads elaborate and convert several designs concurrently, which MyHDL alone cannot do."""

    def convert_all(directory: Path) -> dict[str, str]:
        directory.mkdir(parents=True)
        found = {}
        for number in range(4):
            with elaboration():
                top = everything(**everything_arguments())
            for name, module in converted(top, directory / str(number)).items():
                found[f"{number}/{name}"] = module.path.read_text()
        return found

    before = inspect.stack
    alone = convert_all(tmp_path / "alone")
    with ThreadPoolExecutor(2) as threads:
        together = list(threads.map(convert_all, (tmp_path / "first", tmp_path / "second")))
    assert together == [alone, alone]
    assert inspect.stack is before


def test_myhdls_internals_are_imported_in_one_file():
    found = set()
    for folder in MAY_IMPORT:
        for path in (ROOT / folder).rglob("*.py"):
            if re.search(r"^\s*(?:from|import) myhdl\.(?:_|conversion)", path.read_text(), re.M):
                found.add(path.relative_to(ROOT).as_posix())
    assert found == {"hdl/internals.py"}


def test_myhdl_is_the_version_that_this_was_written_for():
    pins = [line for line in importlib.metadata.requires("raycaster") if line.startswith("myhdl")]
    assert pins == [f"myhdl=={importlib.metadata.version('myhdl')}"]
