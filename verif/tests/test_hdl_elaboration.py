# SPDX-License-Identifier: MIT
"""Elaboration leaves MyHDL and Python as they were, in any thread."""

import inspect
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from hdl_blocks import converted, everything, everything_arguments

from raycaster.hdl import internals
from raycaster.hdl.elaboration import _Frame, elaboration
from raycaster.hdl.signals import bit


def test_elaboration_leaves_nothing_behind():
    before, known = inspect.stack, len(internals.all_signals)
    with elaboration():
        assert inspect.stack is not before
        signal = bit()
        assert internals.all_signals[-1] is signal
    assert inspect.stack is before
    assert len(internals.all_signals) == known


def test_variables_have_the_order_of_python_3_11():
    """Those that an inner function or a comprehension reads follow the others by name; those bound later follow all."""

    def function(second, first):
        read_by_list, read_by_function, plain = 2, 3, 1
        listed = [element + read_by_list for element in range(first)]
        inner = lambda: read_by_function  # noqa: E731
        frame = _Frame(sys._getframe())
        early = list(frame.f_locals)
        late = plain, inner
        return early, list(frame.f_locals), listed, late

    with elaboration():
        early, late, *_ = function(1, 2)
    assert early == ["second", "first", "plain", "listed", "inner", "frame", "read_by_function", "read_by_list"]
    assert late == [*early, "early", "late"]


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
