# SPDX-License-Identifier: MIT
"""`raycaster`: a subcommand's name, and then its own options."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from contextlib import suppress
from types import ModuleType

from raycaster.cli.commands import COMMANDS, Command, overview, verify_overview
from raycaster.errors import UserError, not_installed


def main(argv: Sequence[str] | None = None) -> int:
    """Run a subcommand; returns its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    if not words or words[0] in ("-h", "--help"):
        print(overview())
        return 0
    if words[0] == "verify" and (len(words) == 1 or words[1] in ("-h", "--help")):
        print(verify_overview())
        return 0
    for taken in (2, 1):
        command = COMMANDS.get(" ".join(words[:taken]))
        if command is not None:
            return loaded(command).main(words[taken:]) or 0
    raise UserError(f"{words[0]}: is none of raycaster's commands; raycaster --help lists them")


def loaded(command: Command) -> ModuleType:
    """The module of a command.

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
    """The program."""
    # Loading the options takes a second, which the overview does not wait for.
    if len(sys.argv) == 1:
        with suppress(OSError):  # then `run_command` says so
            print(overview(), flush=True)
            return
    run_command = importlib.import_module("raycaster.options").run_command
    run_command(main)


if __name__ == "__main__":
    run()
