# SPDX-License-Identifier: MIT
"""`raycaster scenes`: list the packaged scenes; with design options, the time that a design takes for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import FEATURES
from raycaster.design.for_scene import design_for, left_out, packaged_for
from raycaster.design.options import CommandParser, add_configuration_options, given_options
from raycaster.errors import UserError
from raycaster.golden import frames
from raycaster.output import Console, Table
from raycaster.rtl.engines import ENGINES
from raycaster.runs.jobs import processes, run_jobs
from raycaster.scene import load_scene, packaged_scenes

MARKS = {"materials": "mirrors"}
"""Words for options whose names say less."""
JOBS = 2


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("scenes", __doc__, "--engine span --units 2")
    add_configuration_options(parser)
    return parser


def _list(console: Console) -> None:
    table = Table("scene", "rows", "reflections", "rectangles", "needs", texts=("needs",))
    for name, path in packaged_scenes().items():
        scene = load_scene(path)
        needs = ", ".join(MARKS.get(feature, feature) for feature in scene.lacks(()))
        table.add_row(name, scene.rows, scene.reflections, len(scene.rect), needs)
    console.print(table)
    for feature, what in FEATURES.items():
        engines = ", ".join(name for name, each in ENGINES.items() if feature in each.facts.features)
        console.print(f"{MARKS.get(feature, feature)}: {what}; engines: {engines}", style="dim")


def _cells(path: Path, options: Mapping[str, Any]) -> tuple[str, int, str, str, str]:
    design = design_for(path, options)
    config = design.configuration
    rows = frames.scene_rows(design.scene, config, design.reflections)
    runs, cycles = frames.runs_of(rows), frames.cycles_of(rows, config)
    shown = frames.shown_hz(cycles, config) if runs <= config.list else f"never: more than {config.list:,} runs"
    return design.name, design.reflections, f"{runs:,}", f"{cycles:,}", shown


def _time(options: Mapping[str, Any], console: Console) -> None:
    table = Table("scene", "reflections", "runs", "cycles per frame", "frames per second", texts=("frames per second",))
    for cells in run_jobs("frames", partial(_cells, options=options), packaged_for(options), processes(JOBS), console):
        table.add_row(*cells)
    console.print(table)
    for reason, names in left_out(options).items():
        console.print(f"{reason}: {', '.join(names)}", style="dim")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command.

    Raises:
        UserError: the options are wrong, or the engine has no frame lists, so that no frame is late.
    """
    options, console = given_options(command_parser().parse_args(argv)), Console()
    if not options:
        _list(console)
        return
    late = [name for name, engine in ENGINES.items() if engine.facts.whole_frames]
    if options.get("engine") not in late:
        raise UserError(f"engine: only frames of {', '.join(late)} may be late; take {as_typed('engine', late[0])}")
    _time(options, console)
