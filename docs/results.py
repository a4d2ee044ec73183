# SPDX-License-Identifier: MIT
"""`raycaster results`: measure the engines, or how they grow, and write all measured tables into the pages."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.configuration import configure
from raycaster.docs.facts import facts
from raycaster.docs.pages import HERE, need_clone, render_all
from raycaster.docs.proofs import proofs
from raycaster.docs.tables import RESULTS, tables
from raycaster.errors import UserError
from raycaster.options import CommandParser
from raycaster.outcomes import add_keep_option, keep
from raycaster.output import Console, printable
from raycaster.scene import packaged_scenes

DESIGNS: tuple[Mapping[str, Any], ...] = (
    {"engine": "seed"},
    {"engine": "exact"},
    {"engine": "beam"},
    {"engine": "beam", "rows": 180},
)
"""Options of the designs that are compared; all else is as by default."""

FAMILY = "ecp5"


def measured(options: Mapping[str, Any], build: Path) -> dict[str, Any]:
    """Show the packaged scenes that every design shows with one, and count its cells.

    Raises:
        UserError: a scene could not be shown as it should be, or the cells could not be counted.
    """
    config = configure(**options)
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    scenes = packaged_scenes(plain=True)
    _run("sim", *words, "--build", str(build), *scenes)
    _run("area", *words, "--family", FAMILY, "--output", str(build / "area"))
    shown = [json.loads((build / "sim" / name / "result.json").read_text()) for name in scenes]
    area = json.loads((build / "area" / "area.json").read_text())
    cells = area["families"][FAMILY]["units"][str(config.units)]
    return {
        "configuration": config.name,
        "options": dict(options),
        "columns": config.screen_geometry.columns,
        "rows": config.screen_geometry.rows,
        "pixels": sum(one["pixels"] for one in shown),
        "wrong_vs_golden": sum(one["wrong_vs_golden"] for one in shown),
        "wrong_vs_exact": sum(one["wrong_vs_exact"] for one in shown),
        "luts": cells["tables"],
        "registers": cells["registers"],
        "multipliers": cells["multipliers"],
        "clock_mhz": config.screen_geometry.clock_hz / 1e6,
    }


def _run(*words: str) -> None:
    done = subprocess.run([sys.executable, "-m", "raycaster.cli", *words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(f"raycaster {' '.join(words)}: {(done.stderr or done.stdout).strip().splitlines()[-1]}")


def _measure_scaling(arguments: argparse.Namespace, console: Console) -> None:
    """Keep how the engines grow, and plot it."""
    from raycaster.docs.scaling import draw_scaling, measure_scaling  # noqa: PLC0415 - wants what reports want

    arguments.keep = arguments.keep or RESULTS / "scaling.json"
    designs = measure_scaling(arguments.output / "scaling", arguments.output, console)
    keep(arguments, {"designs": designs}, {}, left_out="placing and routing")
    kept = json.loads(arguments.keep.read_text())
    draw_scaling(designs, f"{kept['date']}, commit {kept['commit']}", HERE / "scaling.svg")


def _measure_beside(arguments: argparse.Namespace, console: Console) -> None:
    """What others take, which may be rendered without what reports want."""
    from raycaster.report.beside import checkouts_of, measure_beside  # noqa: PLC0415 - wants what reports want

    arguments.keep = arguments.keep or RESULTS / "beside.json"
    scene, checkouts = "boxes", checkouts_of(arguments.beside)
    rows = measure_beside(scene, checkouts, arguments.output / "beside", console)
    keep(arguments, {"designs": rows}, {"scene": scene})


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("results", __doc__, "--render")
    asked = parser.add_mutually_exclusive_group()
    asked.add_argument("--render", action="store_true", help="only write the pages, from what results/ has")
    asked.add_argument("--scaling", action="store_true", help="measure designs of many sizes, which takes an hour")
    asked.add_argument(
        "--beside", nargs="*", metavar="NAME=CHECKOUT", help="measure software, and others' designs where they are"
    )
    parser.add_argument("--output", type=Path, default=Path("build/results"), help="for what is made (%(default)s)")
    add_keep_option(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    need_clone()
    console = Console()
    if arguments.scaling:
        _measure_scaling(arguments, console)
    elif arguments.beside is not None:
        _measure_beside(arguments, console)
    elif not arguments.render:
        arguments.keep = arguments.keep or RESULTS / "engines.json"
        designs = []
        for options in DESIGNS:
            with console.status(f"measuring {configure(**options).name}"):
                designs.append(measured(options, arguments.output / configure(**options).name))
        figures = {"scenes": len(packaged_scenes(plain=True)), "designs": designs}
        keep(arguments, figures, {"rectangles": configure().rectangles}, left_out="placing and routing")
    for page in render_all(facts() | tables() | proofs()):
        print(printable(f"written: {page}"))
