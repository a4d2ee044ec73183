# SPDX-License-Identifier: MIT
"""What `make test` leaves out, and `raycaster verify all`, which does not."""

from __future__ import annotations

from types import SimpleNamespace

import conftest
import pytest

from raycaster.errors import UserError
from raycaster.verif import everything


class Item:
    """A collected test."""

    def __init__(self, name: str):
        self.nodeid, self.marks = f"verif/tests/{name}", []

    def add_marker(self, mark: str) -> None:
        self.marks.append(mark)


def marked(tmp_path, monkeypatch, lines: str, *arguments: str) -> list[bool]:
    """Of three tests, which are slow."""
    (tmp_path / "slow.txt").write_text(lines)
    monkeypatch.setattr(conftest, "SLOW", tmp_path / "slow.txt")
    items = [Item("test_a.py::test_b[1]"), Item("test_a.py::test_b[2]"), Item("test_a.py::test_c")]
    conftest.pytest_collection_modifyitems(SimpleNamespace(args=arguments), items)
    return [item.marks == ["slow"] for item in items]


def test_a_line_is_how_names_begin(tmp_path, monkeypatch):
    lines = "# why\ntest_a.py::test_b\n!test_a.py::test_b[2\ntest_other.py::test_b\n"
    assert marked(tmp_path, monkeypatch, lines) == [True, False, False]


@pytest.mark.parametrize("line", ["test_a.py::test_d", "!test_a.py::test_b[3"])
def test_a_line_about_nothing_is_refused(tmp_path, monkeypatch, line):
    """But where only some tests of a file were asked for."""
    with pytest.raises(pytest.UsageError, match=r"slow.txt: no test begins with test_a"):
        marked(tmp_path, monkeypatch, f"{line}\n")
    assert marked(tmp_path, monkeypatch, f"{line}\n", "verif/tests/test_a.py::test_c") == [False] * 3


def test_all_needs_a_clone(tmp_path, monkeypatch):
    monkeypatch.setattr(everything, "TESTS", tmp_path / "tests")
    with pytest.raises(UserError, match=r"^verify all: the tests come with a clone"):
        everything.main([])


def test_all_is_all(monkeypatch):
    """Pytest is asked for every test, and its exit code is the command's."""
    asked = []

    def run(command, **_):
        asked.append(command)
        return SimpleNamespace(returncode=3)

    monkeypatch.setattr(everything.ensure_tools, "ensure", lambda tool: None)
    monkeypatch.setattr(everything.subprocess, "run", run)
    assert everything.main(["--jobs", "4"]) == 3
    [command] = asked
    assert "-m" not in command[3:]
    assert command[-1] == str(everything.TESTS)
    assert command[command.index("-n") + 1] == "4"
