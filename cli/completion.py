# SPDX-License-Identifier: MIT
"""`raycaster completion`: what a shell needs to complete commands, scenes and options."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import shtab

from raycaster.cli.__main__ import parser_of
from raycaster.cli.commands import COMMANDS
from raycaster.configuration import OPTIONS
from raycaster.options import CommandParser
from raycaster.scene import packaged_scenes


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("completion", __doc__, "bash > ~/.local/share/bash-completion/completions/raycaster")
    parser.add_argument("shell", choices=shtab.SUPPORTED_SHELLS, help="%(choices)s")
    return parser


def whole_parser() -> argparse.ArgumentParser:
    """One parser of all commands."""
    whole = argparse.ArgumentParser("raycaster")
    places = {"": whole.add_subparsers()}
    verify = places[""].add_parser("verify", help="the checks that take long")
    places["verify"] = verify.add_subparsers()
    for name, command in COMMANDS.items():
        place, _, last = name.rpartition(" ")
        parents = [_completed(parser_of(command))]
        places[place].add_parser(last, parents=parents, add_help=False, help=command.purpose)
    return whole


def _completed(parser: CommandParser) -> CommandParser:
    """The parser with what its arguments may be, as far as that is known."""
    for action in parser._actions:
        if action.dest == "scene":
            action.choices = list(packaged_scenes())
        elif action.dest in OPTIONS and action.nargs != 0:
            action.choices = [one for one in get_args(OPTIONS[action.dest].annotation) if isinstance(one, str)] or None
        elif action.type is Path:
            action.complete = shtab.FILE  # pyright: ignore[reportAttributeAccessIssue] shtab's own attribute
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    print(shtab.complete(whole_parser(), arguments.shell))
