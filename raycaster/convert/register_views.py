# SPDX-License-Identifier: MIT
"""`raycaster registers`: write the register map as a C header and a web page, and the memory map as a C header."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from peakrdl_cheader.c_standards import CStandard
from peakrdl_cheader.exporter import CHeaderExporter
from peakrdl_html import HTMLExporter

from raycaster.design.decide import configure
from raycaster.design.options import CommandParser
from raycaster.memory_map import c_header
from raycaster.output import printable, replaced
from raycaster.registers import compile_registers
from raycaster.rtl.engines import ENGINES

HEADER = "raycaster_regs.h"
MEMORY_HEADER = Path("firmware") / "system.h"
SOFTWARE = Path("sw")
"""Folder of the headers that are kept with the sources, relative to the root."""


def write_header(rectangles: int, path: Path, lists: bool = False) -> None:
    """Write the C header: a struct of the registers, and each field's mask, position and width.

    Args:
        rectangles: entries of the hardware's table.
        path: the file; replaced.
        lists: True for a design that draws frames into lists.
    """
    with tempfile.TemporaryDirectory() as scratch:
        # The header's include guard is made from the file's name.
        written = Path(scratch) / HEADER
        CHeaderExporter().export(compile_registers(rectangles, lists), str(written), std=CStandard.gnu99)
        path.write_text(f"// SPDX-License-Identifier: MIT\n{written.read_text()}")


def write_page(rectangles: int, directory: Path, lists: bool = False) -> Path:
    """Write the web page, which a browser opens without a server.

    Args:
        rectangles: entries of the hardware's table, 1 or more.
        directory: replaced as a whole.
        lists: True for a design that draws frames into lists.

    Returns:
        The start page.
    """
    with replaced(directory) as written:
        registers = compile_registers(rectangles, lists)
        HTMLExporter().export(registers, str(written), title="RayCaster registers")  # pyright: ignore[reportArgumentType]
    return directory / "index.html"


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("registers", __doc__, "")
    parser.add_argument(
        "--output", type=Path, default=Path("build/registers"), help="directory of the page (default: %(default)s)"
    )
    parser.add_argument(
        "--software", type=Path, default=SOFTWARE, help="directory of the C headers (default: %(default)s)"
    )
    default = configure().rectangles
    parser.add_argument("--rectangles", default=default, help="entries of the rectangle table (default: %(default)s)")
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    largest = max(ENGINES, key=lambda name: ENGINES[name].facts.rectangles)
    rectangles = configure(engine=largest, rectangles=arguments.rectangles).rectangles
    page = write_page(rectangles, arguments.output)
    arguments.software.mkdir(parents=True, exist_ok=True)
    header = arguments.software / HEADER
    write_header(rectangles, header)
    memory = arguments.software / MEMORY_HEADER
    memory.parent.mkdir(exist_ok=True)
    memory.write_text(c_header())
    print(printable(f"C headers: {header} and {memory}; page: {page}"))
