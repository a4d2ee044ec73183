# SPDX-License-Identifier: MIT
"""`raycaster registers`: the register map for C and for people, and the memory map for C."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from peakrdl_cheader.c_standards import CStandard
from peakrdl_cheader.exporter import CHeaderExporter
from peakrdl_html import HTMLExporter

from raycaster.configuration import configure
from raycaster.memory_map import c_header
from raycaster.options import CommandParser
from raycaster.output import printable, replaced
from raycaster.registers import compile_registers

HEADER = "raycaster_regs.h"
MEMORY_HEADER = Path("firmware") / "system.h"
SOFTWARE = Path("sw")
"""Folder of the headers that are kept with the sources, from the root."""


def write_header(rectangles: int, path: Path) -> None:
    """Write the C header: a struct of the registers, and each field's mask, position and width.

    Args:
        rectangles: entries of the hardware's table, up to 32.
        path: the file; replaced.
    """
    with tempfile.TemporaryDirectory() as scratch:
        # The guard of the header is made of the file's name.
        written = Path(scratch) / HEADER
        CHeaderExporter().export(compile_registers(rectangles), str(written), std=CStandard.gnu99)
        path.write_text(f"// SPDX-License-Identifier: MIT\n{written.read_text()}")


def write_page(rectangles: int, directory: Path) -> Path:
    """Write the page, which a browser opens without a server.

    Args:
        rectangles: entries of the hardware's table, 1 to 32.
        directory: replaced as a whole.

    Returns:
        The page's first file.
    """
    with replaced(directory) as written:
        HTMLExporter().export(compile_registers(rectangles), str(written), title="RayCaster registers")  # pyright: ignore[reportArgumentType]
    return directory / "index.html"


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("registers", __doc__, "")
    parser.add_argument("--output", type=Path, default=Path("build/registers"), help="the page (default: %(default)s)")
    parser.add_argument("--software", type=Path, default=SOFTWARE, help="the C headers (default: %(default)s)")
    default = configure().rectangles
    parser.add_argument("--rectangles", default=default, help="entries of the table (default: %(default)s)")
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    rectangles = configure(rectangles=arguments.rectangles, allow_underrun=True).rectangles
    page = write_page(rectangles, arguments.output)
    arguments.software.mkdir(parents=True, exist_ok=True)
    header = arguments.software / HEADER
    write_header(rectangles, header)
    memory = arguments.software / MEMORY_HEADER
    memory.parent.mkdir(exist_ok=True)
    memory.write_text(c_header())
    print(printable(f"C headers: {header} and {memory}; page: {page}"))
