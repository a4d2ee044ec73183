# SPDX-License-Identifier: MIT
"""`raycaster scenes`: list the packaged scenes."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.configuration import FEATURES
from raycaster.design.options import CommandParser
from raycaster.output import Console, Table
from raycaster.rtl.engines import ENGINES
from raycaster.scene import load_scene, packaged_scenes

MARKS = {"materials": "mirrors"}
"""Words for options whose names say less."""


def command_parser() -> CommandParser:
    """Return the command's parser."""
    return CommandParser("scenes", __doc__, "")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    command_parser().parse_args(argv)
    table = Table("scene", "rows", "reflections", "rectangles", "needs", texts=("needs",))
    for name, path in packaged_scenes().items():
        scene = load_scene(path)
        needs = ", ".join(MARKS.get(feature, feature) for feature in scene.lacks(()))
        table.add_row(name, scene.rows, scene.reflections, len(scene.rect), needs)
    console = Console()
    console.print(table)
    for feature, what in FEATURES.items():
        engines = ", ".join(name for name, each in ENGINES.items() if feature in each.facts.features)
        console.print(f"{MARKS.get(feature, feature)}: {what}; engines: {engines}", style="dim")
