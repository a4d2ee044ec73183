# SPDX-License-Identifier: MIT
"""`raycaster verify all`: run all tests, including the slow ones that `make test` leaves out.

The outcome of each test is kept as soon as it ends. If the sources are the same as in the last run, only the tests
that have not passed yet are run, the longest first; a change in a test file repeats that file only.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.configuration import configure
from raycaster.convert.provenance import Provenance
from raycaster.engines import ENGINES
from raycaster.errors import UserError
from raycaster.jobs import add_fresh_option, positive
from raycaster.options import CommandParser
from raycaster.outcomes import Check, Outcome, add_keep_option, keep
from raycaster.output import Console
from raycaster.sim import ensure_tools

TESTS = Path(__file__).resolve().with_name("tests")
STATE = Path("build/verify-all.jsonl")
"""File of JSON lines, below the root: for each run digests of the sources, names of the tests, and their outcomes."""

PAGES = (".md", ".png", ".svg", ".webp")
"""Suffixes of files that only people read; the tests of the pages are quick."""


class State:
    """Outcomes of tests in this run and in earlier ones.

    Args:
        path: file in which outcomes are kept.

    Attributes:
        sources: digest of all sources except test files.
        files: digests of test files, by name.
        wanted: names of all tests that were requested with these sources.
        outcomes: by test: outcome, seconds and, if it was skipped, the reason.
        seconds: by test: duration of its last run, with any sources.
        walls: wall-clock seconds of each run with these sources.
    """

    def __init__(self, path: Path):
        self._path = path
        self.sources, self.files, self.wanted = "", {}, set()
        self.outcomes, self.seconds, self.walls = {}, {}, []
        for line in path.read_text().splitlines() if path.exists() else ():
            try:
                self._take(json.loads(line))
            except json.JSONDecodeError:  # a line that was cut off when the machine stopped
                continue

    def add(self, entry: Mapping[str, Any]) -> None:
        """Apply an entry, and append it to the file."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a") as file:
            file.write(json.dumps(entry) + "\n")
        self._take(entry)

    def _take(self, entry: Mapping[str, Any]) -> None:
        if "sources" in entry:
            if entry["sources"] != self.sources or entry["fresh"]:
                self.wanted, self.outcomes, self.walls = set(), {}, []
            same = {name for name, digest in entry["files"].items() if digest == self.files.get(name)}
            self.wanted = {test for test in self.wanted if _file(test) in same}
            self.outcomes = {test: outcome for test, outcome in self.outcomes.items() if _file(test) in same}
            self.sources, self.files = entry["sources"], entry["files"]
            self.walls.append(0.0)
        elif "wanted" in entry:
            self.wanted |= set(entry["wanted"])
        else:
            self.outcomes[entry["test"]] = entry
            self.seconds[entry["test"]] = entry["seconds"]
            self.walls[-1] = entry["at"]

    @property
    def passed(self) -> set[str]:
        """Tests that need not run again."""
        return {test for test, entry in self.outcomes.items() if entry["outcome"] == "passed"}

    def figures(self) -> dict[str, Any]:
        """Counts, seconds, and the tests that failed, were skipped or did not run."""
        of = {kind: [t for t, e in self.outcomes.items() if e["outcome"] == kind] for kind in ("failed", "skipped")}
        reasons = Counter(self.outcomes[test]["reason"] for test in of["skipped"])
        return {
            "tests": len(self.wanted | set(self.outcomes)),
            "passed": len(self.passed),
            "failed": sorted(of["failed"]),
            "skipped": dict(reasons),
            "not_run": len(self.wanted - set(self.outcomes)),
            "runs": len(self.walls),
            "seconds": round(sum(entry["seconds"] for entry in self.outcomes.values())),
            "wall_seconds": round(sum(self.walls)),
        }


def _file(test: str) -> str:
    return Path(test.partition("::")[0]).name


class Recorder:
    """Pytest hooks that keep each outcome, in the process that distributes the tests."""

    def __init__(self, state: State):
        self._state, self._start = state, time.monotonic()
        self._phases: dict[str, list[Any]] = {}

    def pytest_xdist_node_collection_finished(self, ids: Sequence[str]) -> None:
        """Keep the names of the tests to run."""
        if not set(ids) <= self._state.wanted:
            self._state.add({"wanted": list(ids)})

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Keep an outcome after the last phase of a test. A worker that crashes reports only one phase."""
        phases = self._phases.setdefault(report.nodeid, [])
        phases.append(report)
        if report.when in ("setup", "call"):
            return
        del self._phases[report.nodeid]
        outcomes = {phase.outcome for phase in phases}
        outcome = next((kind for kind in ("failed", "skipped") if kind in outcomes), "passed")
        reason = ""
        if outcome == "skipped":
            said = next(phase.longrepr for phase in phases if phase.outcome == "skipped")
            reason = str(said[2] if isinstance(said, tuple) else said).removeprefix("Skipped: ")
        self._state.add({
            "test": report.nodeid, "outcome": outcome, "reason": reason,
            "seconds": round(sum(phase.duration for phase in phases), 2),
            "at": round(time.monotonic() - self._start, 1),
        })  # fmt: skip


def pytest_addoption(parser: Any) -> None:
    """Pytest's hook: an option that names the file of outcomes."""
    parser.addoption("--outcomes", type=Path)


def pytest_configure(config: Any) -> None:
    """Pytest's hook: record outcomes, in the process that distributes the tests."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Recorder(State(config.getoption("outcomes"))))


def pytest_collection_modifyitems(config: Any, items: list[Any]) -> None:
    """Pytest's hook, in each worker: leave out tests that have passed, and begin with unknown and long ones."""
    # A separate file that does not change: a worker that replaces a crashed one must find the same tests.
    before = json.loads(_before(config.getoption("outcomes")).read_text())
    if gone := [item for item in items if item.nodeid in before["passed"]]:
        config.hook.pytest_deselected(items=gone)
    left = [item for item in items if item.nodeid not in before["passed"]]
    items[:] = sorted(left, key=lambda item: -before["seconds"].get(item.nodeid, float("inf")))


def _before(outcomes: Path) -> Path:
    return outcomes.with_suffix(".before.json")


def tested_sources(root: Path) -> tuple[str, dict[str, str]]:
    """Digest all files that git does not ignore, except pages and kept figures; digest each test file by name."""
    listed = subprocess.run(
        ["git", "-C", str(root), "ls-files", "-coz", "--exclude-standard"], capture_output=True, text=True, check=True
    )
    found, files = hashlib.sha256(), {}
    for name in sorted(set(listed.stdout.split("\0")) - {""}):
        path = root / name
        if not path.is_file() or path.suffix in PAGES or name.startswith("results/"):
            continue
        if root / TESTS.relative_to(TESTS.parents[1]) in path.parents and path.match("test_*.py"):
            files[path.name] = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            found.update(name.encode() + b"\0" + path.read_bytes())
    return found.hexdigest(), files


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify all", __doc__, "--jobs 4")
    parser.add_argument("--jobs", type=positive, default=2, metavar="N", help="tests at a time (default: %(default)s)")
    add_fresh_option(parser)
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest the default design of each engine, which decides if a page may say that all tests passed."""
    return Provenance([configure(engine=name) for name in ENGINES])


def _found(kept: Outcome) -> str:
    figures = kept.figures
    return (
        f"{figures['passed']:,} of {figures['tests']:,} tests passed, {len(figures['failed'])} failed, "
        f"{sum(figures['skipped'].values())} were skipped and {figures['not_run']} did not run"
    )


CHECKS = (Check("all tests, slow ones included", "each", ["verify-all"], _found),)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; return pytest's exit code, or 130 after an interruption.

    Raises:
        UserError: this is not a clone, so there are no tests.
    """
    arguments = command_parser().parse_args(argv)
    if not TESTS.is_dir():
        raise UserError("verify all: the tests come with a clone, not with the installed program")
    for tool in ensure_tools.TOOLS:
        ensure_tools.ensure(tool)
    root, console = TESTS.parents[1], Console()
    path = root / STATE
    state = State(path)
    sources, files = tested_sources(root)
    state.add({"sources": sources, "files": files, "fresh": arguments.fresh})
    if state.outcomes:
        console.print(f"resumed: {len(state.passed)} of {len(state.wanted)} tests have passed with the same sources")
    _before(path).write_text(json.dumps({"passed": sorted(state.passed), "seconds": state.seconds}))
    # Each worker gets one test at a time, so that the longest begin first.
    words = ["-q", "-n", str(arguments.jobs), "--dist", "load", "--maxschedchunk", "1", "--durations", "10"]
    plugin = ["-p", "raycaster.verif.everything", "--outcomes", str(path)]
    process = subprocess.Popen([sys.executable, "-m", "pytest", *words, *plugin, str(TESTS)], cwd=root)
    try:
        code = process.wait()
    except KeyboardInterrupt:  # pytest gets it too
        process.wait()
        code = 130
    state = State(path)
    figures = state.figures()
    keep(arguments, figures, {"jobs": arguments.jobs}, provenance)
    failed, skipped = len(figures["failed"]), sum(figures["skipped"].values())
    console.print(
        f"{figures['passed']} of {figures['tests']} tests passed, {failed} failed, {skipped} skipped, "
        f"{figures['not_run']} not run; {figures['wall_seconds']} s in {figures['runs']} runs",
    )
    # Pytest's exit code 5: no test is left.
    return 0 if code == 5 and state.wanted == state.passed else code
