# SPDX-License-Identifier: MIT
"""`raycaster verify gate`: check that tests still notice each fault that they noticed when `gate.json` was written.

Mutants are a few faults per leaf test, which `raycaster verify mutate` plants and replays. All other tests of
`gate.json` break hardware, boards, wrappers, drivers, firmware or proofs. A test that passes has noticed its fault; one
that plants several calls `record_property("planted", count)`. A fault that `make test` noticed must not become one that
only slow tests notice. The entry of a renamed test is edited by hand; `--freeze` fills in the faults.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import textwrap
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raycaster.design.options import CommandParser, outside_make
from raycaster.errors import UserError
from raycaster.output import Console, Table
from raycaster.runs.digests import digest
from raycaster.runs.jobs import Kept, add_fresh_option, add_job_options, executors, run_jobs
from raycaster.runs.outcomes import commit_of
from raycaster.verif.mutation.mutate import SEED, leaf_tests, leaves_of_modules, mutate
from raycaster.verif.recording import recording_name

TESTS = Path(__file__).resolve().with_name("tests")
FROZEN = TESTS / "gate.json"
LEAVES, MUTANTS = "leaves", 7
"""Name of the entry that has the mutants; their number per leaf test."""

SPEEDS, SOUND = ("quick", "slow"), ("sound", "-")
"""Parameter sets of `make test`, and those with the marker `slow`; names of parameter sets without a fault."""

Fates = Mapping[str, Mapping[str, int | str]]
"""By speed and parameter set: number of faults that are noticed; for mutants, a 1 for each, and a digest of all."""


@dataclass(frozen=True)
class Planting:
    """Quick or slow parameter sets of a test function that plants faults, such as `test_trace.py::test_a_fault`."""

    test: str
    speed: str
    directory: Path

    def place(self) -> Path:
        """Return the file that keeps the faults that were found."""
        return self.directory / f"{self.test.replace('::', '-')}-{self.speed}.pickle"

    def run(self) -> dict[str, int]:
        """Return the number of faults that the test notices, by the name of the parameter set."""
        report = self.place().with_suffix(".xml")
        report.parent.mkdir(parents=True, exist_ok=True)
        words = ["-q", "-m", "slow" if self.speed == "slow" else "not slow", f"--junitxml={report.resolve()}"]
        command = [sys.executable, "-m", "pytest", *words, str(TESTS / self.test)]
        with report.with_suffix(".log").open("w") as log:
            subprocess.run(command, cwd=TESTS.parents[1], env=outside_make(), stdout=log, stderr=log, check=False)
        found = {}
        for case in ET.parse(report).iter("testcase"):
            name = case.get("name", "").partition("[")[2][:-1] or "it"
            if name not in SOUND and not any(case.findall(outcome) for outcome in ("failure", "error", "skipped")):
                planted = case.find("properties/property[@name='planted']")
                found[name] = 1 if planted is None else int(planted.get("value", ""))
        return found


def mutants_of(arguments: argparse.Namespace, console: Console) -> Fates:
    """Return the mutants that are caught, by leaf test."""
    found: dict[str, dict[str, str]] = {speed: {} for speed in SPEEDS}
    quick = {recording_name(one.partition("::")[2]) for sets in leaf_tests("-m", "not slow").values() for one in sets}
    results, _ = mutate(leaves_of_modules(), MUTANTS, SEED, arguments, console)
    for one in sorted(results, key=lambda result: result.recording):
        caught = "".join(str(int(mutant.caught >= 0)) for mutant in one.mutants)
        found[SPEEDS[one.recording not in quick]][one.recording] = f"{caught} {digest(*map(str, one.mutants))[:6]}"
    return found


def count(*fates: int | str) -> int:
    """Count the faults that are noticed."""
    return sum(fate if isinstance(fate, int) else fate.split()[0].count("1") for fate in fates)


def lost(before: int | str, now: int | str) -> bool:
    """Return True if fewer faults are noticed, or if one of the same mutants is no longer caught."""
    if isinstance(before, str) and isinstance(now, str) and before.split()[1] == now.split()[1]:
        return any(was > is_now for was, is_now in zip(before, now, strict=True))
    return count(now) < count(before)


def differences(test: str, before: Fates, now: Fates) -> Iterator[str]:
    """Describe the faults of a test that were noticed before, and now are not or only by slow tests."""
    for speed in SPEEDS:
        there = {**now["slow"], **now["quick"]} if speed == "slow" else now["quick"]
        for name, fate in before[speed].items():
            if lost(fate, there.get(name, 0)):
                yield f"{test}[{name}]: noticed by {speed} tests before {fate}, now {there.get(name, 0)}"


def written(entries: Mapping[str, Fates]) -> str:
    """Return the text of `gate.json`: a paragraph per test, whose lines break between parameter sets."""
    texts = (f"{json.dumps(test)}: {json.dumps(entry, indent=0)}".replace(" ", "\0") for test, entry in entries.items())
    filled = (textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False) for text in texts)
    return "{\n" + ",\n".join(filled).replace("\0", " ") + "\n}\n"


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify gate", __doc__, "--only test_trace")
    parser.add_argument("--freeze", action="store_true", help="write the faults that tests notice now to gate.json")
    parser.add_argument("--only", default="", metavar="TEXT", help="run only entries whose names contain this text")
    add_job_options(parser)
    add_fresh_option(parser)
    parser.add_argument("--build", type=Path, default=Path("build/gate"), help="output directory (%(default)s)")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; it fails if a fault is no longer noticed.

    Raises:
        UserError: this is not a clone, so there are no tests.
    """
    arguments = command_parser().parse_args(argv)
    if not TESTS.is_dir():
        raise UserError("verify gate: the tests come with a clone, not with the installed program")
    console, frozen, commit = Console(), json.loads(FROZEN.read_text()), commit_of(TESTS)
    asked = {test: entry for test, entry in frozen.items() if arguments.only in test}
    jobs = [Planting(test, speed, arguments.build / commit) for test in asked for speed in SPEEDS if test != LEAVES]
    now: dict[str, dict[str, Any]] = {LEAVES: dict(mutants_of(arguments, console))} if LEAVES in asked else {}
    kept = Kept(Planting.place, arguments.fresh or "+" in commit)  # files have been edited
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        found = run_jobs("tests", Planting.run, jobs, make_executor, console, kept=kept)
    for job, noticed in zip(jobs, found, strict=True):
        now.setdefault(job.test, {})[job.speed] = noticed
    table = Table("test", "kind", "before", "now", title="Faults that tests notice")
    for test, old in asked.items():
        table.add_row(test, old["by"], *(count(*(one["quick"] | one["slow"]).values()) for one in (old, now[test])))
    console.print(table)
    if arguments.freeze:
        FROZEN.write_text(written(frozen | {test: entry | now[test] for test, entry in asked.items()}))
        return 0
    worse = [line for test, entry in asked.items() for line in differences(test, entry, now[test])]
    console.print(*worse, sep="\n", style="red", soft_wrap=True)
    return 1 if worse else 0
