# SPDX-License-Identifier: MIT
"""Selection of slow tests, which `make test` skips, and `raycaster verify all`, which runs every test."""

from __future__ import annotations

import json
import subprocess
from types import SimpleNamespace

import conftest
import pytest

from raycaster.errors import UserError
from raycaster.verif import everything


class Item:
    """A collected test."""

    def __init__(self, name: str, *marks: pytest.Mark):
        self.nodeid, self.marks, self.added, self.stash = f"verif/tests/leaves/{name}", marks, [], {}

    def iter_markers(self, name: str) -> list[pytest.Mark]:
        return [mark for mark in self.marks if mark.name == name]

    def add_marker(self, mark: str) -> None:
        self.added.append(mark)

    def get_closest_marker(self, name: str) -> bool:
        return name in self.added


def collected(mark: pytest.MarkDecorator, *arguments: str) -> tuple[list[bool], list[bool]]:
    """Return whether each of three parameter sets and an unmarked test is slow, and whether MyHDL also simulates it."""
    sets = ("a-1", "a-2", "b-1")
    items = [*(Item(f"test_a.py::test_b[{one}]", mark.mark) for one in sets), Item("test_a.py::test_c")]
    conftest.pytest_collection_modifyitems(SimpleNamespace(args=arguments), items)
    return [item.added == ["slow"] for item in items], [item.stash[conftest.WITH_MYHDL] for item in items]


@pytest.mark.parametrize(
    ("mark", "slow", "in_myhdl"),
    [
        (pytest.mark.slow_sets("a"), [True, True, False, False], [False, False, True, True]),
        (pytest.mark.slow_sets("a", quick=["a-1"]), [False, True, False, False], [False, False, True, True]),
        (pytest.mark.slow_sets(quick=["a-2"]), [True, False, True, False], [False, True, False, True]),
        (pytest.mark.slow_sets("b", "a-1"), [True, False, True, False], [False, True, False, True]),
    ],
    ids=["some", "some with an exception", "all with an exception", "two"],
)
def test_a_mark_is_a_prefix_of_parameter_sets(mark, slow, in_myhdl):
    """MyHDL simulates the last quick set of a leaf test; other tests decide for themselves."""
    assert collected(mark) == (slow, in_myhdl)
    others = [Item("test_b.py::test_b[1]"), Item("test_b.py::test_b[2]")]
    for other in others:
        other.nodeid = other.nodeid.replace("leaves/", "")
    conftest.pytest_collection_modifyitems(SimpleNamespace(args=()), others)
    assert all(other.stash[conftest.WITH_MYHDL] for other in others)


@pytest.mark.parametrize("mark", [pytest.mark.slow_sets("d"), pytest.mark.slow_sets("a", quick=["c"])], ids=["d", "c"])
def test_a_mark_without_a_match_is_refused(mark):
    """When tests are selected by name, some of a test's sets may be missing."""
    with pytest.raises(pytest.UsageError, match=r"slow_sets: no parameter set begins so: \S+test_b: [cd]$"):
        collected(mark)
    collected(mark, "verif/tests/test_a.py::test_b[a-1]")


def test_all_needs_a_clone(tmp_path, monkeypatch):
    monkeypatch.setattr(everything, "TESTS", tmp_path / "tests")
    with pytest.raises(UserError, match=r"^verify all: the tests come with a clone"):
        everything.main([])


TESTS = """
import os, pathlib, time, pytest
@pytest.mark.parametrize("number", range(3))
def test_quick(number):
    pathlib.Path(os.environ["RAN"]).open("a").write(f"quick{number} ")
def test_long():
    pathlib.Path(os.environ["RAN"]).open("a").write("long ")
    time.sleep(1)
def test_wrong():
    pathlib.Path(os.environ["RAN"]).open("a").write("wrong ")
    assert pathlib.Path(os.environ["MENDED"]).exists()
def test_absent():
    pytest.skip("no such board")
"""


@pytest.fixture
def run_all(tmp_path, monkeypatch, names_for_digests):
    """Return a function that runs the command on a small clone and returns its exit code, tests run and figures."""
    clone, ran, kept = tmp_path / "clone", tmp_path / "ran", tmp_path / "clone" / "results" / "kept.json"
    tests = clone / "verif" / "tests"
    tests.mkdir(parents=True)
    (tests / "test_small.py").write_text(TESTS)
    (clone / ".gitignore").write_text("build\n__pycache__\n.pytest_cache\n")
    subprocess.run(["git", "init", "-q", str(clone)], check=True)
    monkeypatch.setattr(everything.ensure_tools, "ensure", lambda tool: None)
    monkeypatch.setattr(everything, "TESTS", tests)
    # Each run starts two interpreters, which load only the plugin that they need.
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTEST_PLUGINS", "xdist.plugin")
    monkeypatch.setenv("RAN", str(ran))
    monkeypatch.setenv("MENDED", str(tmp_path / "mended"))

    def run(*options: str):
        ran.write_text("")
        code = everything.main(["--jobs", "1", "--keep", str(kept), *options])
        return code, ran.read_text().split(), json.loads(kept.read_text())["figures"]

    return run


def test_all_is_resumed(run_all, tmp_path, capsys):
    code, ran, figures = run_all()
    assert code == 1
    assert sorted(ran) == ["long", "quick0", "quick1", "quick2", "wrong"]
    assert figures["failed"] == ["verif/tests/test_small.py::test_wrong"]
    assert figures["skipped"] == {"no such board": 1}
    assert (figures["tests"], figures["passed"], figures["not_run"], figures["runs"]) == (6, 4, 0, 1)
    # With the same sources, only tests that have not passed yet run.
    (tmp_path / "mended").touch()
    code, ran, figures = run_all()
    assert (code, ran, figures["failed"], figures["passed"], figures["runs"]) == (0, ["wrong"], [], 5, 2)
    assert "resumed: 4 of 6 tests have passed" in capsys.readouterr().out
    # A fresh run starts with the longest test.
    code, ran, figures = run_all("--fresh")
    assert (code, ran[0], len(ran), figures["runs"]) == (0, "long", 5, 1)
    # After a source has changed, all tests run again.
    (tmp_path / "clone" / "rtl.py").write_text("changed")
    assert len(run_all()[1]) == 5
    # A page is not a source, and a new or changed test file runs only its own tests.
    (tmp_path / "clone" / "page.md").write_text("changed")
    tests = tmp_path / "clone" / "verif" / "tests" / "leaves"
    tests.mkdir()
    (tests / "test_more.py").write_text(TESTS.replace("quick", "more"))
    code, ran, figures = run_all()
    assert sorted(ran) == ["long", "more0", "more1", "more2", "wrong"]
    assert (code, figures["tests"], figures["passed"]) == (0, 12, 10)
    (tests / "test_more.py").write_text(TESTS.replace("quick", "other"))
    code, ran, figures = run_all()
    assert sorted(ran) == ["long", "other0", "other1", "other2", "wrong"]
    assert (code, figures["tests"], figures["passed"]) == (0, 12, 10)


def test_results_of_an_interrupted_run_are_kept(tmp_path):
    """The state file ends where the machine stopped, possibly in the middle of a line."""
    state = everything.State(tmp_path / "state")
    state.add({"sources": "a", "files": {}, "fresh": False})
    state.add({"wanted": ["x", "y"]})
    state.add({"test": "x", "outcome": "passed", "reason": "", "seconds": 2.0, "at": 3.0})
    with (tmp_path / "state").open("a") as file:
        file.write('{"test": "y", "out')
    figures = everything.State(tmp_path / "state").figures()
    assert (figures["tests"], figures["passed"], figures["not_run"], figures["wall_seconds"]) == (2, 1, 1, 3)
