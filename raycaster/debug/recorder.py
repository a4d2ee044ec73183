# SPDX-License-Identifier: MIT
"""Record waveforms of some rows of a frame; they stay small however large the design is."""

from __future__ import annotations

import argparse
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.design.for_scene import Design
from raycaster.design.options import add_build_option, add_configuration_options, add_scene_argument
from raycaster.errors import UserError
from raycaster.fit.fixing import add_fix_option
from raycaster.output import Console, check_replaceable, put, replaced
from raycaster.scene import find_scene
from raycaster.sim.job import Job
from raycaster.sim.simulator import (
    WINDOW_BENCH,
    Model,
    SimulationError,
    add_simulator_option,
    announced,
    build_model,
    find_tool,
    run_bench,
)

MARGIN = 32
"""Clocks after the end of the last row, in which its last pixels reach the pins."""

LATEST = 20
"""Frames of the monitor after which a whole frame of the scene should be shown."""


def add_recording_options(parser: argparse.ArgumentParser, pixel: str) -> None:
    """Add the options that choose the design and the rows to record, with a help text for `--pixel`."""
    add_scene_argument(parser, "scene to record (default: mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument("--pixel", metavar="COLUMN,ROW", help=pixel)
    add_simulator_option(parser)
    add_build_option(parser)
    add_fix_option(parser)
    add_configuration_options(parser)


def pixel_place(text: str) -> tuple[int, int]:
    """Parse a pixel's column and row.

    Raises:
        UserError: the text is not two numbers.
    """
    column, comma, row = text.partition(",")
    if not (comma and column.strip().isdecimal() and row.strip().isdecimal()):
        raise UserError(f"pixel: expected a ray's column and row, as in 160,120, got {text}")
    return int(column), int(row)


def window_of(configuration: Configuration, first_row: int, last_row: int) -> dict[str, int]:
    """Describe when rows are computed and shown, for `wave_window.v`.

    A line buffer is filled while the previous row is shown, and StartScreen comes a row's time before the first row is
    shown. Rows of whole frames are drawn at times of their own, before the frame is shown.
    """
    screen, facts = configuration.screen_geometry, configuration.facts
    first = first_row + 1 if facts.whole_frames else first_row
    window = {"window_from": first * screen.row_cycles, "window_to": (last_row + 2) * screen.row_cycles + MARGIN}
    if facts.whole_frames:
        # Units that are ahead keep their runs until the rows above are complete.
        window |= {"row_from": max(0, first_row - 1), "row_to": last_row + configuration.units}
        window |= {"row_rest": configuration.units * screen.columns + MARGIN}
        window["window_last"] = LATEST * screen.frame_cycles
    return window


def record(model: Model, design: Design, rows: tuple[int, int], target: Path) -> Path:
    """Simulate a scene's frame up to the last of some rows, write the waveform of these rows, and return its path.

    Args:
        model: a model with a window bench.
        design: the scene, and the configuration of the model.
        rows: the first and the last row of rays.
        target: the output directory, replaced once the waveform is complete; it also gets the simulation's log.

    Raises:
        SimulationError: the simulation failed.
    """
    window = window_of(design.configuration, *rows)
    job = Job(design.configuration, scene=str(design.path.resolve()), reflections=design.reflections)
    with replaced(target) as filled:
        partial = filled.resolve()
        options = {"window_file": partial / model.wave_file, **window}
        plusargs = [f"+{name}={value}" for name, value in options.items()]
        try:
            run_bench(model, "raycaster.debug.wave_bench", job, partial, plusargs=plusargs)
            if not (partial / model.wave_file).exists():
                raise SimulationError(f"{model.simulator} wrote no waveform; its log is {partial / 'sim.log'}")
        except SimulationError as error:
            failed = target.with_name(f"{target.name}-failed")
            put(filled, failed)
            raise SimulationError(str(error).replace(str(partial), str(failed))) from None
    return target / model.wave_file


def build_and_record(
    arguments: argparse.Namespace, design: Design, rows: tuple[int, int], target: Path, console: Console
) -> Path | None:
    """Record some rows like `record`, after building the model if there is none, and show the user the progress.

    Returns:
        The waveform's path; None if the model or the simulation failed, after showing the reason.

    Raises:
        UserError: the simulator is missing.
    """
    check_replaceable(target)
    find_tool(arguments.simulator)
    config, simulator = design.configuration, arguments.simulator
    try:
        with announced(console, f"building {config.name} with {simulator}", config.facts):
            model = build_model(config, simulator, build=arguments.build, bench=WINDOW_BENCH)
        with console.waiting("simulating"):
            return record(model, design, rows, target)
    except SimulationError as error:
        console.print(str(error), style="red", soft_wrap=True)
        return None
