# SPDX-License-Identifier: MIT
"""Flip bits of a running design, reset it or misuse its bus, and see when its picture is right again."""

from __future__ import annotations

import argparse
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.table import Table

from raycaster.configuration import Configuration, configure, need_avalon
from raycaster.convert.provenance import Provenance
from raycaster.errors import UserError
from raycaster.jobs import add_fresh_option, add_job_options, executors
from raycaster.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    command_line,
    given_options,
)
from raycaster.outcomes import Check, add_keep_option, keep, scope_of
from raycaster.outcomes import Outcome as Kept
from raycaster.output import Console
from raycaster.sim.simulator import VERILATOR_FLAGS, convert
from raycaster.verif.campaign import Campaign, run_campaign
from raycaster.verif.upsets.bench import KINDS

FLAGS = tuple(flag for flag in VERILATOR_FLAGS if flag != "--no-public-flat-rw")
"""Flags that let a bench write every register."""

SHARE = 50
"""Number of cases per simulation."""

OUTCOMES = ("unseen", "StartScreen", "commit", "hangs")
"""Outcomes: never visible, repaired by the next StartScreen, repaired by the next commit, or never repaired."""


def registers_of(files: Sequence[Path]) -> dict[str, tuple[str, ...]]:
    """Return the registers and memories of each module: the names that are assigned at a clock edge.

    Args:
        files: converted Verilog, one module per file, with each such assignment on a separate line.
    """
    found = {}
    for file in files:
        text = file.read_text()
        for module in re.findall(r"^module (\w+)", text, re.MULTILINE):
            found[module] = tuple(sorted(set(re.findall(r"^\s*(\w+)(?:\[[^=]*\])? <= ", text, re.MULTILINE))))
    return found


def show(results: Sequence[Mapping], seconds: float, configuration: Configuration, console: Console) -> None:
    """Print the outcomes of the cases, by kind."""
    table = Table(title=f"{configuration.name}, {len(results)} cases in {seconds:.0f} s")
    table.add_column("disturbance")
    for heading in (
        "cases",
        "unseen",
        "repaired by StartScreen",
        "by a commit",
        "never",
        "frames wrong, at most",
        "sync",
    ):
        table.add_column(heading, justify="right")
    for kind in dict.fromkeys(KINDS):
        of_kind = [result for result in results if result["kind"] == kind]
        outcomes = Counter(result["outcome"] for result in of_kind)
        most = max((result["wrong"] for result in of_kind), default=0)
        counts = [len(of_kind), *(outcomes[each] for each in OUTCOMES), most]
        table.add_row(kind, *(f"{count:,}" for count in [*counts, sum(each["lost_sync"] for each in of_kind)]))
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify upsets", __doc__, "--engine exact --cases 200")
    parser.add_argument("--cases", type=int, default=500, metavar="N", help="number of cases (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="CASE", help="number of the first case (%(default)s)")
    add_job_options(parser)
    add_fresh_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def _configuration(arguments: argparse.Namespace) -> Configuration:
    return configure(**{"screen": "tiny", "allow_underrun": True} | given_options(arguments))


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest everything that decides the figures of the command."""
    return Provenance([_configuration(arguments)], ["golden", "verif/upsets"])


def _found(*kept: Kept) -> str:
    figures = [one.figures for one in kept]
    cases = sum(one["cases"] for one in figures)
    hung = sum(one[kind].get("hangs", 0) for one in figures for kind in set(KINDS))
    flips = sum((Counter(one["upset"]) for one in figures), Counter())
    most = max(one["most_wrong"] for one in figures)
    return (
        f"{cases:,} cases, {hung} never recovered; {flips.total():,} flipped bits: "
        f"{flips['unseen']:,} did not show, {flips['StartScreen']:,} were repaired by the next StartScreen, "
        f"{flips['commit']:,} by a commit; at most {most} frames were wrong"
    )


CHECKS = (
    Check(
        "bits flipped, resets, misuse of the bus while it draws, tiny, 3 rectangles", "each, seed with culling",
        ["upsets-seed", "upsets-exact", "upsets-beam"], _found,
    ),
)  # fmt: skip


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    if arguments.cases < 1 or arguments.first < 0:
        raise UserError("cases: must be 1 or more, first: 0 or more")
    configuration = _configuration(arguments)
    need_avalon(configuration, "verify upsets")
    console = Console()
    cases = range(arguments.first, arguments.first + arguments.cases)
    campaign = Campaign(
        "raycaster.verif.upsets.bench", configuration, cases, arguments.build / "upsets", arguments.build,
        flags=FLAGS, registers=registers_of(convert(configuration, arguments.build)), share=SHARE,
        fresh=arguments.fresh,
    )  # fmt: skip
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        outcome = run_campaign(campaign, console, make_executor)
    results = outcome.results
    show(results, outcome.seconds, configuration, console)
    for result in results:
        if result["outcome"] == "hangs":
            repeat = command_line(
                "verify upsets", options={"cases": 1, "first": result["case"]} | given_options(arguments)
            )
            what = f"case {result['case']}: {result['kind']}, {result['where']}, clock {result['clock']:.0f}"
            console.print(f"{what}: did not recover; repeat with: {repeat}", style="red", soft_wrap=True)
    figures = {"cases": len(results), "not_run": outcome.missing} | {
        kind: dict(Counter(result["outcome"] for result in results if result["kind"] == kind))
        for kind in dict.fromkeys(KINDS)
    }
    figures["most_wrong"] = max((result["wrong"] for result in results), default=0)
    figures["lost_sync"] = sum(result["lost_sync"] for result in results)
    keep(arguments, figures, scope_of(configuration), provenance)
    return outcome.verdict("cases", console)
