# SPDX-License-Identifier: MIT
"""Selection of slow tests, which `make test` skips, and `raycaster verify all`, which runs every test."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from types import SimpleNamespace

import conftest
import pytest
from conftest import set_day

from raycaster.errors import UserError
from raycaster.output import Console
from raycaster.verif import everything, seeds


def item(name: str, *marks: pytest.Mark) -> SimpleNamespace:
    """Return a stand-in for a collected test; `added` has the names of the marks that it gets."""
    added = []
    return SimpleNamespace(
        nodeid=f"verif/tests/{name}", stash={}, added=added, add_marker=added.append,
        get_closest_marker=lambda name: name in added,
        iter_markers=lambda name: [mark for mark in marks if mark.name == name],
    )  # fmt: skip


def collected(mark: pytest.MarkDecorator, *arguments: str) -> tuple[list[bool], list[bool]]:
    """Return whether each of three parameter sets and an unmarked test is slow, and whether MyHDL also simulates it."""
    sets = ("a-1", "a-2", "b-1")
    items = [*(item(f"leaves/test_a.py::test_b[{one}]", mark.mark) for one in sets), item("leaves/test_a.py::test_c")]
    conftest.pytest_collection_modifyitems(SimpleNamespace(args=arguments), items)
    return [one.added == ["slow"] for one in items], [one.stash[conftest.WITH_MYHDL] for one in items]


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
    others = [item("test_b.py::test_b[1]"), item("test_b.py::test_b[2]")]
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
def ran(name):
    pathlib.Path(os.environ["RAN"] + ".seed").write_text(os.environ["RAYCASTER_SEED"])
    pathlib.Path(os.environ["RAN"]).open("a").write(name + " ")
@pytest.mark.parametrize("number", range(2))
def test_quick(number):
    ran(f"quick{number}")
def test_long():
    ran("long")
    assert "RAYCASTER_FROM_MAKE" not in os.environ
    time.sleep(0.5)
def test_wrong():
    ran("wrong")
    assert pathlib.Path(os.environ["MENDED"]).exists()
def test_absent():
    pytest.skip("no such board")
"""


@pytest.fixture
def clone(tmp_path, monkeypatch, names_for_digests):
    """Return a small clone for the command, with two files of tests."""
    tests = tmp_path / "clone" / "verif" / "tests"
    (tests / "leaves").mkdir(parents=True)
    (tests / "test_small.py").write_text(TESTS)
    (tests / "leaves" / "test_more.py").write_text(TESTS.replace("quick", "more").split("def test_long")[0])
    (tmp_path / "clone" / ".gitignore").write_text("build\n__pycache__\n.pytest_cache\n")
    subprocess.run(["git", "init", "-q", str(tmp_path / "clone")], check=True)
    monkeypatch.setattr(everything.ensure_tools, "ensure", lambda tool: None)
    monkeypatch.setattr(everything, "TESTS", tests)
    # Each run starts two interpreters, which load only the plugin that they need.
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTEST_PLUGINS", "xdist.plugin")
    monkeypatch.setenv("RAYCASTER_FROM_MAKE", "1")
    monkeypatch.setenv("RAN", str(tmp_path / "ran"))
    monkeypatch.setenv("MENDED", str(tmp_path / "mended"))
    return tmp_path / "clone"


def run_all(clone: Path) -> tuple[int, list[str], dict]:
    """Run the command; return its exit code, the tests that it ran, in order, and its figures."""
    ran, kept = clone.with_name("ran"), clone / "results" / "kept.json"
    ran.write_text("")
    code = everything.main(["--jobs", "1", "--keep", str(kept)])
    return code, ran.read_text().split(), json.loads(kept.read_text())["figures"]


def test_all_is_resumed(clone, capsys, monkeypatch):
    """A run that did not pass keeps the seed of its day; one that has passed begins anew on another day."""
    set_day(monkeypatch, 5)
    code, ran, figures = run_all(clone)
    assert (code, figures["seed"], clone.with_name("ran.seed").read_text()) == (1, 20261205, "20261205")
    assert sorted(ran) == ["long", "more0", "more1", "quick0", "quick1", "wrong"]
    assert figures["failed"] == ["verif/tests/test_small.py::test_wrong"]
    assert figures["skipped"] == {"no such board": 1}
    assert [figures[name] for name in ("tests", "passed", "not_run", "runs")] == [7, 5, 0, 1]
    # Tests that have not passed run again, and those of a changed test file; a page is not a source.
    clone.with_name("mended").touch()
    set_day(monkeypatch, 6)
    (clone / "page.md").write_text("changed")
    more = clone / "verif" / "tests" / "leaves" / "test_more.py"
    more.write_text(more.read_text().replace("more", "other"))
    code, ran, figures = run_all(clone)
    assert (code, sorted(ran)) == (0, ["other0", "other1", "wrong"])
    assert [figures[name] for name in ("tests", "passed", "failed", "runs", "seed")] == [7, 6, [], 2, 20261205]
    said = capsys.readouterr().out
    assert "seed 20261205, of the unfinished run that is resumed; repeat with: make verify-all SEED=20261205" in said
    assert "resumed: 3 of 5 tests have passed" in said
    # After a source has changed, all tests run again, the longest first.
    (clone / "rtl.py").write_text("changed")
    code, ran, figures = run_all(clone)
    assert (code, ran[0], len(ran), figures["runs"], figures["seed"]) == (0, "long", 6, 1, 20261206)
    # The next day has another seed, with which no test has run.
    set_day(monkeypatch, 7)
    code, ran, figures = run_all(clone)
    assert (code, len(ran), clone.with_name("ran.seed").read_text()) == (0, 6, "20261207")
    assert "seed 20261207, by date; repeat with: make verify-all SEED=20261207" in capsys.readouterr().out


@pytest.mark.parametrize("words", [["--seed", "5"], []], ids=["option", "environment"])
def test_a_seed_that_is_asked_for(words, capsys, monkeypatch):
    monkeypatch.setenv(seeds.VARIABLE, "5" if not words else "6")
    asked = everything.command_parser().parse_args(words).seed
    assert seeds.drawn("verify all", asked, 7, Console()) == 5
    assert "seed 5, as asked for; repeat with: raycaster verify all --seed 5\n" in capsys.readouterr().out


def test_results_of_an_interrupted_run_are_kept(tmp_path):
    """The state file ends where the machine stopped, possibly in the middle of a line; a fresh run forgets it."""
    state = everything.State(tmp_path / "state")
    begin = {"sources": "a", "files": {"x": "b", "y": "c"}, "fresh": False}
    state.add(begin)
    state.add(*({"test": test, "outcome": "not_run", "seconds": 0} for test in ("x", "y")))
    state.add({"test": "x", "outcome": "passed", "reason": "", "seconds": 2.0, "at": 3.0})
    with (tmp_path / "state").open("a") as file:
        file.write('{"test": "y", "out')
    state = everything.State(tmp_path / "state")
    assert [state.figures()[name] for name in ("tests", "passed", "not_run", "wall_seconds")] == [2, 1, 1, 3]
    state.add(begin | {"fresh": True})
    assert (state.tests, state.seconds) == ({}, {"x": 2})
