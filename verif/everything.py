# SPDX-License-Identifier: MIT
"""`raycaster verify all`: run all tests, including the slow ones that `make test` leaves out.

Random tests get a new seed each day. The outcome of each test is kept as soon as it ends. If sources and seed are the
same as in the last run, only the tests that have not passed yet are run, the longest first; a change in a test file
repeats that file only. A run in which tests are left keeps its seed on the next day.
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
from raycaster.digests import PAGES
from raycaster.engines import ENGINES
from raycaster.errors import UserError
from raycaster.jobs import add_fresh_option, positive
from raycaster.options import CommandParser, outside_make
from raycaster.outcomes import Check, add_keep_option, keep
from raycaster.output import Console
from raycaster.sim import ensure_tools
from raycaster.verif.seeds import VARIABLE, add_seed_option, drawn

TESTS = Path(__file__).resolve().with_name("tests")
STATE = Path("build/verify-all.jsonl")
"""File of JSON lines, below the root: for each run digests of the sources, names of the tests, and their outcomes."""


class State:
    """Outcomes of tests in this run and in earlier ones with the same sources.

    Args:
        path: file in which they are kept: an entry for each run with digests of the sources, followed by one for each
            test that is not known yet and for each outcome.

    Attributes:
        tests: by name: outcome, seconds and, if the test was skipped, the reason.
        seconds: by name: duration of the last run, with any sources.
        walls: wall-clock seconds of each run.
    """

    def __init__(self, path: Path):
        self._path = path
        self._run: Mapping[str, Any] = {"sources": "", "files": {}, "seed": None}
        self.tests, self.seconds, self.walls = {}, {}, []
        for line in path.read_text().splitlines() if path.exists() else ():
            try:
                self._take(json.loads(line))
            except json.JSONDecodeError:  # a line that was cut off when the machine stopped
                continue

    def add(self, *entries: Mapping[str, Any]) -> None:
        """Apply entries, and append them to the file."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a") as file:
            file.write("".join(json.dumps(entry) + "\n" for entry in entries))
        for entry in entries:
            self._take(entry)

    def _take(self, entry: Mapping[str, Any]) -> None:
        if "sources" in entry:
            before, self._run = self._run, entry
            if entry["fresh"] or any(entry.get(name) != before.get(name) for name in ("sources", "seed")):
                self.tests, self.walls = {}, []
            same = {name for name, digest in entry["files"].items() if digest == before["files"].get(name)}
            self.tests = {test: found for test, found in self.tests.items() if Path(test.split("::")[0]).name in same}
            self.walls.append(0.0)
            return
        self.tests[entry["test"]] = entry
        if entry["outcome"] != "not_run":
            self.seconds[entry["test"]], self.walls[-1] = entry["seconds"], entry["at"]

    def seed_to_resume(self, sources: str) -> int | None:
        """Return the last run's seed if its sources are the same and tests failed or did not run."""
        same = self._run["sources"] == sources and (self.of("failed") or self.of("not_run"))
        return self._run.get("seed") if same else None

    def of(self, outcome: str) -> list[str]:
        """List the tests with an outcome."""
        return sorted(test for test, entry in self.tests.items() if entry["outcome"] == outcome)

    def figures(self) -> dict[str, Any]:
        """The seed, counts, seconds, and the tests that failed, were skipped or did not run."""
        return {
            "seed": self._run.get("seed"),
            "tests": len(self.tests),
            "passed": len(self.of("passed")),
            "failed": self.of("failed"),
            "skipped": dict(Counter(self.tests[test]["reason"] for test in self.of("skipped"))),
            "not_run": len(self.of("not_run")),
            "runs": len(self.walls),
            "seconds": round(sum(entry["seconds"] for entry in self.tests.values())),
            "wall_seconds": round(sum(self.walls)),
        }


class Recorder:
    """Pytest hooks that keep each outcome, in the process that distributes the tests."""

    def __init__(self, state: State):
        self._state, self._start = state, time.monotonic()
        self._before = {"passed": state.of("passed"), "seconds": dict(state.seconds)}
        self._phases: dict[str, list[Any]] = {}

    def pytest_configure_node(self, node: Any) -> None:
        """Pass the same earlier outcomes to all workers: one that replaces a crashed one must find the same tests."""
        node.workerinput["before"] = self._before

    def pytest_xdist_node_collection_finished(self, ids: Sequence[str]) -> None:
        """Keep the names of the tests to run."""
        new = [test for test in ids if test not in self._state.tests]
        self._state.add(*({"test": test, "outcome": "not_run", "seconds": 0} for test in new))

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Keep an outcome after the last phase of a test. A worker that crashes reports only one phase."""
        phases = self._phases.setdefault(report.nodeid, [])
        phases.append(report)
        if report.when in ("setup", "call"):
            return
        del self._phases[report.nodeid]
        found = {phase.outcome: phase.longrepr for phase in phases}
        outcome = next((kind for kind in ("failed", "skipped") if kind in found), "passed")
        self._state.add({
            "test": report.nodeid, "outcome": outcome,
            "reason": found["skipped"][2].removeprefix("Skipped: ") if outcome == "skipped" else "",
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
    before = config.workerinput["before"]
    if gone := [item for item in items if item.nodeid in before["passed"]]:
        config.hook.pytest_deselected(items=gone)
    left = [item for item in items if item.nodeid not in before["passed"]]
    items[:] = sorted(left, key=lambda item: -before["seconds"].get(item.nodeid, float("inf")))


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
    add_seed_option(parser)
    add_fresh_option(parser)
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest the default design of each engine, which decides if a page may say that all tests passed."""
    return Provenance([configure(engine=name) for name in ENGINES])


def _said(figures: Mapping[str, Any]) -> str:
    return (
        f"{figures['passed']:,} of {figures['tests']:,} tests passed, {len(figures['failed'])} failed, "
        f"{sum(figures['skipped'].values())} were skipped and {figures['not_run']} did not run"
    )


CHECKS = (Check("all tests, slow ones included", "each", ["verify-all"], lambda kept: _said(kept.figures)),)


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
    unfinished = None if arguments.fresh else state.seed_to_resume(sources)
    seed = drawn("verify all", arguments.seed, unfinished, console)
    state.add({"sources": sources, "files": files, "fresh": arguments.fresh, "seed": seed})
    if state.tests:
        passed = len(state.of("passed"))
        console.print(f"resumed: {passed} of {len(state.tests)} tests have passed with the same sources and seed")
    # Each worker gets one test at a time, so that the longest begin first.
    words = ["-q", "-n", str(arguments.jobs), "--dist", "load", "--maxschedchunk", "1", "--durations", "10"]
    plugin = ["-p", "raycaster.verif.everything", "--outcomes", str(path)]
    command = [sys.executable, "-m", "pytest", *words, *plugin, str(TESTS)]
    process = subprocess.Popen(command, cwd=root, env=outside_make() | {VARIABLE: str(seed)})
    try:
        code = process.wait()
    except KeyboardInterrupt:  # pytest gets it too
        process.wait()
        code = 130
    figures = State(path).figures()
    keep(arguments, figures, {"jobs": arguments.jobs}, provenance)
    console.print(f"{_said(figures)}; {figures['wall_seconds']} s in {figures['runs']} runs")
    # Pytest's exit code 5: no test is left.
    return 0 if code == 5 and figures["passed"] == figures["tests"] else code
