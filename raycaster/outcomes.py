# SPDX-License-Identifier: MIT
"""Measured figures, kept in files by `--keep results/<name>.json` and published as tables in the pages.

A file has the command that repeats the measurement, and digests of everything that affects the figures.
`raycaster results --stale` compares these with the current project; `raycaster results --render` writes the pages.
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
from typing import Any, Protocol

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration
from raycaster.errors import UserError

RESULTS = Path(__file__).parents[1] / "results"
WHERE = re.compile(r" --(?:output|build|keep|jobs)[ =](?:'[^']*'|\S+)")
"""Options of a command that do not affect what it measures."""


Digests = Mapping[str, Mapping[str, str]]
"""Digests of everything that affects a command's figures, by kind (designs, sources, tools) and by name."""


class Provenance(Protocol):
    """Everything that affects a command's figures; implemented in `raycaster.convert.provenance`."""

    def digests(self) -> Digests:
        """Compute the digests."""
        ...


@dataclass(frozen=True)
class Outcome:
    """Figures that a command measured, as kept in a file.

    Attributes:
        name: name of the file, without its suffix.
        command: command line, without the options that say where output goes.
        date: day of the measurement, as 2026-11-24.
        commit: commit that was checked out; a plus means that files had been edited.
        scope: description of what the figures apply to.
        figures: measured figures.
        provenance: digests at the time of the measurement; empty in files from before there were digests.
        changed: names in the provenance whose digests have changed since.
    """

    name: str
    command: str
    date: str
    commit: str
    scope: Mapping[str, Any]
    figures: Mapping[str, Any]
    provenance: Digests
    changed: Sequence[str] = ()

    @property
    def when(self) -> str:
        """Day of the measurement for a table cell, marked if the figures are stale."""
        return f"{self.date}, **stale**" if self.changed else self.date

    def asked(self, command: str = "") -> str:
        """Return the command line without a given beginning."""
        return self.command.removeprefix(command).strip()


@dataclass(frozen=True)
class Published:
    """A table in the pages, or a few words within a line.

    Attributes:
        name: name of the marker in the pages, as in `<!--name-->`.
        kept: names of its source files; a pattern, as in `bitstream-*`, stands for several.
        body: makes Markdown from these outcomes.
        dated: True if the body itself says when the figures were measured.
    """

    name: str
    kept: Sequence[str]
    body: Callable[..., str]
    dated: bool = False


@dataclass(frozen=True)
class Check:
    """A row of the table of long checks.

    Attributes:
        title: name of the check.
        engine: engine, with the relevant part of its configuration.
        kept: names of its source files.
        body: describes in words what was found, from these outcomes.
    """

    title: str
    engine: str
    kept: Sequence[str]
    body: Callable[..., str]


def table(headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Format a table in Markdown, with numbers aligned to the right."""
    rows = list(rows)
    texts = [[f"{cell:,}" if isinstance(cell, int) else str(cell) for cell in row] for row in rows]
    rules = ["---:" if all(isinstance(cell, int) for cell in column) else "---" for column in zip(*rows, strict=True)]
    return "\n".join(f"| {' | '.join(line)} |" for line in [headings, rules, *texts])


def add_keep_option(parser: argparse.ArgumentParser) -> None:
    """Add `--keep`."""
    parser.add_argument("--keep", type=Path, metavar="JSON", help="write the figures and their scope to this file")


def scope_of(configuration: Configuration) -> dict[str, Any]:
    """Return the scope of figures that apply to one design."""
    return {
        "configuration": configuration.name,
        "engine": configuration.engine,
        "culling": bool(configuration.culling),
    }


def keep(
    arguments: argparse.Namespace,
    figures: Mapping[str, Any],
    scope: Mapping[str, Any],
    provenance: Callable[[argparse.Namespace], Provenance],
    left_out: str = "",
) -> None:
    """Write what was measured to the file that `--keep` names, if it was given.

    Args:
        arguments: command line, as parsed by `CommandParser`.
        figures: measured figures.
        scope: `scope_of` the design, or another description.
        provenance: function that returns everything that affects the command's figures.
        left_out: anything that a reader might think was measured too, in a few words.
    """
    if arguments.keep is None:
        return
    outcome = {
        "command": WHERE.sub("", arguments.command_line),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "commit": commit_of(Path(__file__).parent),
        "scope": {**scope, "left_out": left_out},
        "provenance": provenance(arguments).digests(),
        "figures": figures,
    }
    arguments.keep.parent.mkdir(parents=True, exist_ok=True)
    partial = arguments.keep.with_suffix(".partial")
    partial.write_text(json.dumps(outcome, indent=1) + "\n")
    partial.replace(arguments.keep)


def kept_outcome(path: Path) -> Outcome:
    """Read a kept file, without finding out what has changed since.

    Raises:
        UserError: the file cannot be read.
    """
    try:
        kept: dict[str, Any] = json.loads(path.read_text())
    except OSError as error:
        raise UserError(
            f"{path}: cannot be read: {error.strerror}; a command with {as_typed('keep', path)} writes it"
        ) from None
    kept = {"provenance": {}} | {name: kept[name] for name in kept if name != "tools"}
    kept["command"] = WHERE.sub("", kept["command"])
    return Outcome(path.stem, **kept)


def commit_of(directory: Path) -> str:
    """Return the commit that is checked out, with a plus if files have been edited; empty outside a clone."""
    words = ["git", "-C", str(directory), "describe", "--always", "--exclude=*", "--dirty=+"]
    try:
        return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()
    except FileNotFoundError:
        return ""
