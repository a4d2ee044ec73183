# SPDX-License-Identifier: MIT
"""`raycaster`: dispatch to a subcommand, with its options."""

from __future__ import annotations

import importlib
import importlib.metadata
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING
from unittest.mock import MagicMock

from raycaster.cli.commands import COMMANDS, Command, overview, unknown_command, verify_overview
from raycaster.errors import UserError, not_installed
from raycaster.places import links_complaint

if TYPE_CHECKING:
    from raycaster.design.options import CommandParser


def main(argv: Sequence[str] | None = None) -> int:
    """Run a subcommand and return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    if not words or words[0] in ("-h", "--help"):
        print(overview())
        return 0
    if words[0] == "verify" and (len(words) == 1 or words[1] in ("-h", "--help")):
        print(verify_overview())
        return 0
    if words[0] == "--version":
        print(f"raycaster {importlib.metadata.version('raycaster')}")
        return 0
    for taken in (2, 1):
        command = COMMANDS.get(" ".join(words[:taken]))
        if command is not None:
            if {"-h", "--help"} & {*words[taken:]}:
                parser_of(command).parse_args(words[taken:])
            return loaded(command).main(words[taken:]) or 0
    raise UserError(unknown_command(" ".join(words[: 2 if words[0] == "verify" else 1])))


def parser_of(command: Command) -> CommandParser:
    """Return the parser of a command, even if its extra is not installed: mocks replace missing packages."""
    while True:
        try:
            return importlib.import_module(command.module).command_parser()
        except ModuleNotFoundError as error:
            if not error.name or error.name.startswith("raycaster"):
                raise
            sys.modules[error.name] = MagicMock()


def loaded(command: Command) -> ModuleType:
    """Import the module of a command.

    Raises:
        UserError: it needs an extra that is not installed.
    """
    try:
        return importlib.import_module(command.module)
    except ModuleNotFoundError as error:
        if not command.extra or not error.name or error.name.startswith("raycaster"):
            raise
        raise UserError(not_installed(error.name, command.extra)) from None


def run() -> None:
    """Run the program."""
    # Loading the options takes a second, so the overview is printed without them.
    if len(sys.argv) == 1:
        with suppress(OSError):  # `run_command` then reports it
            print(overview(), flush=True)
            return
    try:
        run_command = importlib.import_module("raycaster.design.options").run_command
    except ModuleNotFoundError as error:
        complaint = links_complaint(Path(__file__).resolve().parents[2])
        if not complaint or not str(error.name).startswith("raycaster."):
            raise
        print(f"error: {complaint}", file=sys.stderr)
        sys.exit(2)
    run_command(main)


if __name__ == "__main__":
    run()
