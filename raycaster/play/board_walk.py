# SPDX-License-Identifier: MIT
"""`raycaster walk`: walk through a room on a board with the bus uart, with keys in the terminal."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Iterator, Sequence

from raycaster.design.options import CommandParser, add_scene_argument
from raycaster.errors import UserError
from raycaster.output import Console
from raycaster.play.board import Board, add_port_options
from raycaster.play.walk import Walker
from raycaster.scene import find_scene

try:
    import termios
    import tty
except ImportError:  # Windows
    termios = tty = None

KEYS = {
    "w": "forward", "s": "back", "a": "left", "d": "right", "r": "rise", "f": "sink",
    "\x1b[A": "look up", "\x1b[B": "look down", "\x1b[C": "turn right", "\x1b[D": "turn left",
}  # fmt: skip
"""Buttons of a walk by what the terminal sends for a key."""

HELP = "w a s d walk, arrows turn, r and f rise and sink, q ends"


def keys() -> Iterator[str]:
    """Yield the keys that are pressed in the terminal, until q or the end of the input."""
    while text := os.read(sys.stdin.fileno(), 64).decode(errors="replace"):
        while text:
            key = text[:3] if text.startswith("\x1b[") else text[0]
            if key == "q":
                return
            yield key
            text = text[len(key) :]


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("walk", __doc__, "room.toml --port /dev/ttyUSB0")
    add_scene_argument(parser, "room to walk through (mirror_room)", default=find_scene("mirror_room"))
    add_port_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    if termios is None or tty is None:
        raise UserError("walk: needs a terminal of Linux or macOS; `raycaster send` works here")
    if not sys.stdin.isatty():
        raise UserError("walk: takes keys from a terminal; run it in one")
    board = Board(arguments.port, arguments.rate)
    walker = Walker(board.scene(arguments.scene), board.config)
    board.show(walker.load())
    Console().print(HELP)
    before = termios.tcgetattr(sys.stdin)
    try:
        tty.setcbreak(sys.stdin)
        for key in keys():
            if key in KEYS:
                walker.move({KEYS[key]})
                # Keys that repeat faster than frames go over the line are put together.
                if not select.select([sys.stdin], [], [], 0)[0]:
                    board.write(walker.writes())
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
