# SPDX-License-Identifier: MIT
"""Wrong pixels and cell counts of the designs that the README compares."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from raycaster.configuration import configure
from raycaster.convert.provenance import Provenance
from raycaster.engines import ENGINES
from raycaster.errors import UserError
from raycaster.fpga.cells import DECIDES, FAMILIES, TOOLS, measure
from raycaster.outcomes import Outcome, Published, table
from raycaster.scene import packaged_scenes
from raycaster.sim.scenes import RESULT, output_directory

DESIGNS: tuple[Mapping[str, Any], ...] = (
    *({"engine": name} for name in ENGINES),
    {"engine": "beam", "rows": 180},
)
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
    cells = measure(config, FAMILIES["ecp5"], build / "cells")
    return {
        "configuration": config.name,
        "options": dict(options),
        "columns": config.screen_geometry.columns,
        "rows": config.screen_geometry.rows,
        "pixels": sum(one["pixels"] for one in shown),
        "wrong_vs_golden": sum(one["wrong_vs_golden"] for one in shown),
        "wrong_vs_exact": sum(one["wrong_vs_exact"] for one in shown),
        "luts": cells.tables,
        "registers": cells.registers,
        "multipliers": cells.multipliers,
        "clock_mhz": config.screen_geometry.clock_hz / 1e6,
    }


def provenance() -> Provenance:
    """Return the designs, sources and tools that decide these figures."""
    return Provenance([configure(**options) for options in DESIGNS], ["golden", "scenes", *DECIDES], TOOLS)


def _options(design: Mapping[str, Any]) -> str:
    return f"`{' '.join(f'{name.upper()}={value}' for name, value in design.items())}`"


def _engines(kept: Outcome) -> str:
    """Return the README's table and the note below it."""
    figures = kept.figures
    rows = [
        [
            _options(row["options"]), f"{row['columns']} x {row['rows']}",
            f"{row['wrong_vs_exact']:,} of {row['pixels']:,}", row["luts"], row["registers"], row["multipliers"],
            f"{row['clock_mhz']:g} MHz",
        ]
        for row in figures["designs"]
    ]  # fmt: skip
    headings = ["engine", "rays per frame", "wrong pixels", "LUT4", "registers", "multipliers", "required clock"]
    unlike = sum(row["wrong_vs_golden"] for row in figures["designs"])
    note = (
        f"Wrong pixels differ from exact arithmetic, counted over {figures['scenes']} scenes; {unlike} pixels differ "
        "from the engine's own model. Cell counts are Yosys's for an ECP5, before placement. Each design holds "
        f"{kept.scope['rectangles']} rectangles; the seed engine has culling, the others do not."
    )
    return f"{table(headings, rows)}\n\n{note}"


def _work(kept: Outcome) -> str:
    """Return the table of units and cycles of the same designs, from their configurations."""
    rows = []
    for row in kept.figures["designs"]:
        config = configure(**row["options"])
        rays = config.screen_geometry.columns * config.screen_geometry.rows
        rows.append([_options(row["options"]), f"{rays:,}", config.units, config.group_cycles,
                     f"{config.units / config.group_cycles:.3f}"])  # fmt: skip
    return table(
        ["engine", "pixels computed per frame", "units", "cycles per pixel of each unit", "pixels per clock"], rows
    )


PUBLISHED = (
    Published("engines", ["engines"], _engines),
    Published("work", ["engines"], _work, dated=True),
)
