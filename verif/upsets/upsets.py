# SPDX-License-Identifier: MIT
"""Flip bits of a running design, reset it or misuse its bus, and see when its picture is right again."""

from __future__ import annotations

import argparse
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from raycaster.configuration import Configuration, configure, need_avalon
from raycaster.convert.digest import verilog_digest
from raycaster.options import CommandParser, given_options
from raycaster.outcomes import keep
from raycaster.output import Console, Table
from raycaster.sim.simulator import VERILATOR_FLAGS, convert
from raycaster.verif.campaign import Campaign, add_campaign_options, repeated, run_asked
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
    title = f"{configuration.name}, {len(results)} cases in {seconds:.0f} s"
    repaired = "unseen", "repaired by StartScreen", "by a commit", "never"
    table = Table("disturbance", "cases", *repaired, "frames wrong, at most", "sync", title=title)
    for kind in dict.fromkeys(KINDS):
        of_kind = [result for result in results if result["kind"] == kind]
        outcomes = Counter(result["outcome"] for result in of_kind)
        most = max((result["wrong"] for result in of_kind), default=0)
        lost_sync = sum(each["lost_sync"] for each in of_kind)
        table.add_row(kind, len(of_kind), *(outcomes[each] for each in OUTCOMES), most, lost_sync)
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify upsets", __doc__, "--engine exact --cases 200")
    add_campaign_options(parser, "cases", 500)
    return parser


def _configuration(arguments: argparse.Namespace) -> Configuration:
    return configure(**{"screen": "tiny", "allow_underrun": True} | given_options(arguments))


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that is disturbed."""
    return verilog_digest(_configuration(arguments))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    configuration, console = _configuration(arguments), Console()
    need_avalon(configuration, "verify upsets")
    cases = range(arguments.first, arguments.first + arguments.cases)
    campaign = Campaign(
        "raycaster.verif.upsets.bench", configuration, cases, arguments.build / "upsets", arguments.build,
        flags=FLAGS, registers=registers_of(convert(configuration, arguments.build)), share=SHARE,
    )  # fmt: skip
    outcome = run_asked(campaign, arguments, console)
    results = outcome.results
    show(results, outcome.seconds, configuration, console)
    figures = {"cases": len(results), "not_run": outcome.missing} | {
        kind: dict(Counter(result["outcome"] for result in results if result["kind"] == kind))
        for kind in dict.fromkeys(KINDS)
    }
    figures["most_wrong"] = max((result["wrong"] for result in results), default=0)
    figures["lost_sync"] = sum(result["lost_sync"] for result in results)
    keep(arguments, figures, verilog)
    hangs = [
        f"case {one['case']}: {one['kind']}, {one['where']}, clock {one['clock']:.0f}: did not recover; "
        + repeated("verify upsets", arguments, cases=1, first=one["case"])
        for one in results
        if one["outcome"] == "hangs"
    ]
    return outcome.verdict("cases", console, hangs)
