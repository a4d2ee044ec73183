# SPDX-License-Identifier: MIT
"""`raycaster options`: list the options of a design, which most commands take."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.complaints import as_typed
from raycaster.design.decide import OPTIONS
from raycaster.design.options import CommandParser, shown_default
from raycaster.output import Console, Table


def command_parser() -> CommandParser:
    """Return the command's parser."""
    return CommandParser("options", __doc__, "")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    command_parser().parse_args(argv)
    table = Table("option", "meaning", "default", texts=("meaning", "default"))
    for name in OPTIONS:
        table.add_row(as_typed(name), OPTIONS[name].description, shown_default(OPTIONS[name]))
    Console().print(table)
