# SPDX-License-Identifier: MIT
"""`raycaster completion`: print a script with which a shell completes commands, scenes and options."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import shtab

from raycaster.cli.__main__ import parser_of
from raycaster.cli.commands import COMMANDS
from raycaster.design.decide import OPTIONS
from raycaster.design.options import CommandParser
from raycaster.scene import packaged_scenes


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("completion", __doc__, "bash > ~/.local/share/bash-completion/completions/raycaster")
    parser.add_argument("shell", choices=shtab.SUPPORTED_SHELLS, help="shell: %(choices)s")
    return parser


def whole_parser() -> argparse.ArgumentParser:
    """Return a single parser for all commands."""
    whole = argparse.ArgumentParser("raycaster")
    places = {"": whole.add_subparsers()}
    verify = places[""].add_parser("verify", help="run a long check")
    places["verify"] = verify.add_subparsers()
    for name, command in COMMANDS.items():
        place, _, last = name.rpartition(" ")
        parents = [_completed(parser_of(command))]
        places[place].add_parser(last, parents=parents, add_help=False, help=command.purpose)
    return whole


def _completed(parser: CommandParser) -> CommandParser:
    """Add the known values of each argument to a parser, and return it."""
    for action in parser._actions:
        if action.dest == "scene":
            action.choices = list(packaged_scenes())
        elif action.dest in OPTIONS and action.nargs != 0:
            action.choices = [one for one in get_args(OPTIONS[action.dest].annotation) if isinstance(one, str)] or None
        elif action.type is Path:
            action.complete = shtab.FILE  # pyright: ignore[reportAttributeAccessIssue] shtab's own attribute
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    print(shtab.complete(whole_parser(), arguments.shell))
