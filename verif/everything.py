# SPDX-License-Identifier: MIT
"""`raycaster verify all`: run all tests, including the slow ones that `make test` leaves out.

Random tests get a new seed each day. A run that was interrupted, or in which tests failed, is resumed on the same
commit, with its seed, by the tests that have not passed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from raycaster.convert.digest import verilog_digest
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser, outside_make
from raycaster.errors import UserError
from raycaster.output import Console
from raycaster.rtl.engines import ENGINES
from raycaster.runs.jobs import add_fresh_option, positive
from raycaster.runs.outcomes import add_keep_option, commit_of, keep
from raycaster.sim import ensure_tools
from raycaster.verif.seeds import VARIABLE, add_seed_option, drawn

TESTS = Path(__file__).resolve().with_name("tests")
PASSED, REPORT = Path("build/verify-all.passed"), Path("build/verify-all.xml")
"""Below the root: the unfinished run's commit and seed, with a line per test that passed; the last run's JUnit file."""


class Recorder:
    """Pytest hooks that keep the name of each test that passes, in the process that distributes the tests."""

    def __init__(self, path: Path):
        self._path, self._called = path, set()
        self._before = path.read_text().splitlines()[1:]

    def pytest_configure_node(self, node: Any) -> None:
        """Pass the same names to all workers: one that replaces a crashed one must find the same tests."""
        node.workerinput["passed"] = self._before

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Keep a test's name once it has been taken down."""
        if report.passed and report.when == "call":
            self._called.add(report.nodeid)
        if report.passed and report.when == "teardown" and report.nodeid in self._called:
            with self._path.open("a") as file:
                file.write(report.nodeid + "\n")


def pytest_addoption(parser: Any) -> None:
    """Pytest's hook: add the option with which the command calls this plugin."""
    parser.addoption("--passed", type=Path)


def pytest_configure(config: Any) -> None:
    """Pytest's hook: record passed tests, in the process that distributes the tests."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Recorder(config.getoption("passed")))


def pytest_collection_modifyitems(config: Any, items: list[Any]) -> None:
    """Pytest's hook, in each worker: leave out tests that have passed."""
    passed = set(config.workerinput["passed"])
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid in passed])
    items[:] = [item for item in items if item.nodeid not in passed]


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify all", __doc__, "--jobs 4")
    parser.add_argument("--jobs", type=positive, default=2, metavar="N", help="tests at a time (default: %(default)s)")
    add_seed_option(parser)
    add_fresh_option(parser)
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the default design of each engine."""
    return verilog_digest(*(configure(engine=name) for name in ENGINES))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; return pytest's exit code, or 130 after an interruption. Figures are kept if no test failed.

    Raises:
        UserError: this is not a clone, so there are no tests.
    """
    arguments = command_parser().parse_args(argv)
    if not TESTS.is_dir():
        raise UserError("verify all: the tests come with a clone, not with the installed program")
    for tool in ensure_tools.TOOLS:
        ensure_tools.ensure(tool)
    root, console = TESTS.parents[1], Console()
    passed, commit = root / PASSED, commit_of(TESTS)
    passed.parent.mkdir(exist_ok=True)
    kept = passed.read_text().splitlines() if passed.exists() and not arguments.fresh else []
    # Edited files have no name that would be the same only while they are.
    unfinished = int(kept[0].split()[1]) if kept and kept[0].split()[0] == commit and "+" not in commit else None
    seed = drawn("verify all", arguments.seed, unfinished, console)
    before = kept[1:] if seed == unfinished else []
    passed.write_text("".join(f"{line}\n" for line in [f"{commit} {seed}", *before]))
    if before:
        console.print(f"resumed: {len(before)} tests have passed with the same commit and seed")
    words = ["-q", "-n", str(arguments.jobs), "--dist", "worksteal", "--durations", "10", f"--junitxml={root / REPORT}"]
    command = [sys.executable, "-m", "pytest", *words, "-p", __name__, "--passed", str(passed), str(TESTS)]
    process = subprocess.Popen(command, cwd=root, env=outside_make() | {VARIABLE: str(seed)})
    try:
        code = process.wait()
    except KeyboardInterrupt:  # pytest gets it too
        process.wait()
        return 130
    if code == 0:
        counts = ElementTree.parse(root / REPORT).getroot()[0].attrib
        figures = {
            "seed": seed,
            "passed": len(passed.read_text().splitlines()) - 1,
            "skipped": int(counts["skipped"]),
            "last_run_seconds": round(float(counts["time"])),
        }
        keep(arguments, figures, verilog)
        passed.unlink()
    return code
