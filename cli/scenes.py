# SPDX-License-Identifier: MIT
"""`raycaster scenes`: list the packaged scenes."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.options import CommandParser
from raycaster.output import Console, Table
from raycaster.scene import load_scene, packaged_scenes


def command_parser() -> CommandParser:
    """Return the command's parser."""
    return CommandParser("scenes", __doc__, "")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    command_parser().parse_args(argv)
    table = Table("scene", "title", "rows", "reflections", "rectangles", texts=("title",))
    for name, path in packaged_scenes().items():
        scene = load_scene(path)
        table.add_row(name, scene.title, scene.rows, scene.reflections, len(scene.rect))
    Console().print(table)
