# SPDX-License-Identifier: MIT
"""`raycaster results`: measure what the README's table says of each engine, and write it there."""

from __future__ import annotations

import datetime
import json
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.options import CommandParser
from raycaster.scene import packaged_scenes

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
RESULTS = ROOT / "results" / "engines.json"

DESIGNS: tuple[Mapping[str, Any], ...] = (
    {"engine": "seed"},
    {"engine": "exact"},
    {"engine": "beam"},
    {"engine": "beam", "rows": 180},
)
"""Options of the designs that are compared; all else is as by default."""

FAMILY = "ecp5"
BEGIN, END = "<!-- begin: raycaster results -->\n", "<!-- end: raycaster results -->\n"


def measured(options: Mapping[str, Any], build: Path) -> dict[str, Any]:
    """Show all packaged scenes with a design, and count its cells.

    Raises:
        UserError: a scene could not be shown as it should be, or the cells could not be counted.
    """
    config = configure(**options)
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    _run("sim", *words, "--build", str(build))
    _run("area", *words, "--family", FAMILY, "--output", str(build / "area"))
    shown = [json.loads((build / "sim" / name / "result.json").read_text()) for name in packaged_scenes()]
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


def table(results: Mapping[str, Any]) -> str:
    """The README's table, and the line that says what it is of."""
    lines = [
        "| engine | rays a frame | wrong pixels | LUT4 | registers | multipliers | clock it needs |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for row in results["designs"]:
        wrong = f"{row['wrong_vs_exact']:,} of {row['pixels']:,}"
        lines.append(
            f"| `{' '.join(f'{name.upper()}={value}' for name, value in row['options'].items())}` "
            f"| {row['columns']} x {row['rows']} | {wrong} "
            f"| {row['luts']:,} | {row['registers']:,} | {row['multipliers']} | {row['clock_mhz']:g} MHz |"
        )
    lines += [
        "",
        f"Wrong: unlike exact arithmetic, in {results['scenes']} scenes; unlike the model of the same engine: "
        f"{sum(row['wrong_vs_golden'] for row in results['designs'])}. Cells: of an ECP5, as Yosys counts them. "
        "12 rectangles, reflections as the scenes have them, all else by default. "
        f"Measured on {results['date']} by `raycaster results`.",
    ]
    return "\n".join(lines) + "\n"


def rendered(readme: str, results: Mapping[str, Any]) -> str:
    """The README with the table of these results.

    Raises:
        UserError: it has no place for it.
    """
    pattern = re.compile(re.escape(BEGIN) + ".*?" + re.escape(END), re.DOTALL)
    if not pattern.search(readme):
        raise UserError(f"{README}: has no line {BEGIN.strip()}")
    return pattern.sub(lambda _: BEGIN + table(results) + END, readme)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    parser = CommandParser("results", __doc__, "--render")
    parser.add_argument("--render", action="store_true", help="only write the README's table from what was measured")
    parser.add_argument("--output", type=Path, default=Path("build/results"), help="for what is made (%(default)s)")
    arguments = parser.parse_args(argv)
    if not arguments.render:
        console, designs = Console(), []
        for options in DESIGNS:
            with console.status(f"measuring {configure(**options).name}"):
                designs.append(measured(options, arguments.output / configure(**options).name))
        commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
        results = {
            "command": "raycaster results",
            "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
            "commit": commit.stdout.strip(),
            "scenes": len(packaged_scenes()),
            "designs": designs,
        }
        RESULTS.write_text(json.dumps(results, indent=2) + "\n")
    README.write_text(rendered(README.read_text(), json.loads(RESULTS.read_text())))
    print(f"{RESULTS} and {README}")
