# SPDX-License-Identifier: MIT
"""`raycaster import`: make a scene file from a map of characters."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from raycaster.design.options import CommandParser, command_line
from raycaster.errors import UserError
from raycaster.level import load_level
from raycaster.output import Console
from raycaster.scene import dump_scene

MARK = "# Made by raycaster import"
"""Beginning of a file that the command may replace."""


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("import", __doc__, "level.txt")
    parser.add_argument("map", type=Path, help="text file with the map; the manual's page about scenes describes it")
    parser.add_argument("-o", "--output", type=Path, help="scene file (default: the map's name with .toml)")
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    output = arguments.output or arguments.map.with_suffix(".toml")
    if output.exists() and not (output.is_file() and output.read_bytes().startswith(MARK.encode())):
        raise UserError(f"{output}: is there already, and was not made by raycaster import; choose another --output")
    scene = load_level(arguments.map)
    partial = output.with_name(f"{output.name}.partial")
    partial.write_text(f"{MARK} from {arguments.map.name}.\n{dump_scene(scene)}", encoding="utf-8")
    partial.replace(output)
    count, walk = len(scene.rect), command_line("play", output)
    Console().print(f"{output}: {count} rectangle{'s' * (count > 1)}; to walk through it: {walk}", soft_wrap=True)
