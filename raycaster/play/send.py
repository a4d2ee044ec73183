# SPDX-License-Identifier: MIT
"""`raycaster send`: show a room on a board with the bus uart."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.design.options import CommandParser, add_scene_argument
from raycaster.output import Console
from raycaster.play.board import Board, add_port_options
from raycaster.program import scene_words
from raycaster.scene import find_scene


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("send", __doc__, "room.toml --port /dev/ttyUSB0")
    add_scene_argument(parser, "room to show (mirror_room)", default=find_scene("mirror_room"))
    add_port_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    board = Board(arguments.port, arguments.rate)
    scene = board.scene(arguments.scene)
    board.show(scene_words(scene, board.config))
    held = board.config.rectangles
    Console().print(
        f"{arguments.scene}: sent, {len(scene.rect)} of at most {held} rectangles, {board.config.engine} engine",
        soft_wrap=True,
    )
