# SPDX-License-Identifier: MIT
"""Measured figures: kept in a file by `--keep results/<name>.json`, and published as tables of the pages.

A file has the command that measures its figures again, and digests of everything that decides them.
`raycaster results --stale` compares these with the project as it is; `raycaster results --render` writes the pages.
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

from raycaster.configuration import Configuration
from raycaster.errors import UserError

RESULTS = Path(__file__).parents[1] / "results"
WHERE = re.compile(r" --(?:output|build|keep|jobs)[ =](?:'[^']*'|\S+)")
"""Options of a command that decide nothing of what it measures."""


Digests = Mapping[str, Mapping[str, str]]
"""Digests of what decides a command's figures: by kind (designs, sources, tools), and by name."""


class Provenance(Protocol):
    """What decides a command's figures; `raycaster.convert.provenance` has it."""

    def digests(self) -> Digests:
        """Digest all of it."""
        ...


@dataclass(frozen=True)
class Outcome:
    """A kept file: what a command measured.

    Attributes:
        name: of the file, without its suffix.
        command: the command line, without the options that say where output goes.
        date: the day, as 2026-11-24.
        commit: the commit that was checked out; a plus means that files had been edited.
        scope: what the figures are true of.
        figures: what was measured.
        provenance: the digests when it was measured; empty in a file that was kept before there were any.
        changed: names in the provenance that have another digest by now.
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
        """The day, for a cell of a table; marked where the figures are stale."""
        return f"{self.date}, **stale**" if self.changed else self.date

    def asked(self, command: str = "") -> str:
        """The command line without this beginning."""
        return self.command.removeprefix(command).strip()


@dataclass(frozen=True)
class Published:
    """A table of the pages, or a few words within a line.

    Attributes:
        name: on the pages, as in `<!--name-->`.
        kept: the files that it is made of, by name; a pattern, as in `bitstream-*`, stands for several.
        body: makes Markdown of these outcomes.
        dated: says in the body itself when the figures were measured.
    """

    name: str
    kept: Sequence[str]
    body: Callable[..., str]
    dated: bool = False


@dataclass(frozen=True)
class Check:
    """A row of the table of long checks.

    Attributes:
        title: what was checked.
        engine: which engine, and what matters of its configuration.
        kept: the files that it is made of, by name.
        body: says in words what was found, from these outcomes.
    """

    title: str
    engine: str
    kept: Sequence[str]
    body: Callable[..., str]


def table(headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown; numbers are aligned to the right."""
    rows = list(rows)
    texts = [[f"{cell:,}" if isinstance(cell, int) else str(cell) for cell in row] for row in rows]
    rules = ["---:" if all(isinstance(cell, int) for cell in column) else "---" for column in zip(*rows, strict=True)]
    return "\n".join(f"| {' | '.join(line)} |" for line in [headings, rules, *texts])


def add_keep_option(parser: argparse.ArgumentParser) -> None:
    """Add `--keep`."""
    parser.add_argument("--keep", type=Path, metavar="JSON", help="write the figures, with their scope, to this file")


def scope_of(configuration: Configuration) -> dict[str, Any]:
    """The scope of a figure that is true of one design."""
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
        arguments: the command line, as `CommandParser` made it.
        figures: what was measured.
        scope: `scope_of` the design, or another description.
        provenance: the command's function that says what decides its figures.
        left_out: what a reader might think was measured too, in a few words.
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
    """Read a kept file; nothing is said of what has changed since.

    Raises:
        UserError: it cannot be read.
    """
    try:
        kept: dict[str, Any] = json.loads(path.read_text())
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}; a command with --keep {path} writes it") from None
    kept = {"provenance": {}} | {name: kept[name] for name in kept if name != "tools"}
    kept["command"] = WHERE.sub("", kept["command"])
    return Outcome(path.stem, **kept)


def commit_of(directory: Path) -> str:
    """What is checked out; with a plus where the files are not those of the commit, empty outside of a clone."""
    words = ["git", "-C", str(directory), "describe", "--always", "--exclude=*", "--dirty=+"]
    try:
        return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()
    except FileNotFoundError:
        return ""
