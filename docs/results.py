# SPDX-License-Identifier: MIT
"""`raycaster results`: measure the engines that the README compares, and write all measured tables into the pages."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.convert.digest import verilog_digest
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser
from raycaster.docs.facts import facts
from raycaster.docs.hdl import parts
from raycaster.docs.pages import need_clone, render_all
from raycaster.docs.proofs import proofs
from raycaster.docs.tables import is_stale, tables
from raycaster.errors import UserError
from raycaster.fpga.cells import FAMILIES, measure
from raycaster.output import Console, Table, printable
from raycaster.rtl.engines import ENGINES
from raycaster.runs.outcomes import RESULTS, add_keep_option, keep, kept_outcomes
from raycaster.scene import packaged_scenes
from raycaster.sim.scenes import RESULT, output_directory

DESIGNS: tuple[Mapping[str, Any], ...] = (*({"engine": name} for name in ENGINES), {"engine": "span", "rows": 180})
"""Options of the compared designs; all other options have their defaults."""


def measured(options: Mapping[str, Any], build: Path) -> dict[str, Any]:
    """Draw the packaged scenes that every design can show, and count the cells of a design.

    Raises:
        UserError: a scene failed or had wrong pixels, or the cells could not be counted.
    """
    config = configure(**options)
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    scenes = packaged_scenes(plain=True)
    command = [sys.executable, "-m", "raycaster.cli", "sim", *words, "--build", str(build), *scenes]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(f"{' '.join(command[2:])}: {(done.stderr or done.stdout).strip().splitlines()[-1]}")
    output = output_directory(build, [config.engine], options)
    shown = [json.loads((output / name / RESULT).read_text()) for name in scenes]
    cells, screen = measure(config, FAMILIES["ecp5"], build / "cells"), config.screen_geometry
    return {
        "options": dict(options), "columns": screen.columns, "rows": screen.rows,
        **{name: sum(one[name] for one in shown) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")},
        "luts": cells.tables, "registers": cells.registers, "multipliers": cells.multipliers,
        "clock_mhz": screen.clock_hz / 1e6,
    }  # fmt: skip


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("results", __doc__, "--render")
    asked = parser.add_mutually_exclusive_group()
    asked.add_argument("--render", action="store_true", help="only update the pages, from the files in results/")
    asked.add_argument(
        "--stale", action="store_true", help="only list the figures in results/, and which no longer hold"
    )
    parser.add_argument(
        "--output", type=Path, default=Path("build/results"), help="directory for output files (%(default)s)"
    )
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog of the compared designs."""
    return verilog_digest(*(configure(**options) for options in DESIGNS))


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    need_clone()
    console = Console()
    if arguments.stale:
        shown = Table("results/", "measured", "commit", "", "command", texts=("measured", "commit", "", "command"))
        for path in sorted(RESULTS.glob("*.json")):
            for one in kept_outcomes(path):
                shown.add_row(path.stem, one.date, one.commit, "stale" if is_stale(one) else "holds", one.command)
        console.print(shown)
        return
    if not arguments.render:
        designs = []
        for options in DESIGNS:
            name = configure(**options).name
            with console.waiting(f"measuring {name}"):
                designs.append(measured(options, arguments.output / name))
        arguments.keep = arguments.keep or RESULTS / "engines.json"
        figures = {"rectangles": configure().rectangles, "scenes": len(packaged_scenes(plain=True)), "designs": designs}
        keep(arguments, figures, verilog, "placing and routing")
    for page in render_all(facts() | tables() | proofs() | parts()):
        print(printable(f"written: {page}"))
