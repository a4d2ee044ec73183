# SPDX-License-Identifier: MIT
"""`raycaster scenes`: list the packaged scenes."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table

from raycaster.options import CommandParser
from raycaster.output import Console
from raycaster.scene import load_scene, packaged_scenes


def command_parser() -> CommandParser:
    """Return the command's parser."""
    return CommandParser("scenes", __doc__, "")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    command_parser().parse_args(argv)
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("scene", "title", "rows", "reflections", "rectangles"):
        table.add_column(heading, justify="left" if heading in ("scene", "title") else "right")
    for name, path in packaged_scenes().items():
        scene = load_scene(path)
        table.add_row(name, scene.title, str(scene.rows), str(scene.reflections), str(len(scene.rect)))
    Console().print(table)
