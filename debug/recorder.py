# SPDX-License-Identifier: MIT
"""Waveforms of some rows of a frame, which stay small however large the design is."""

from __future__ import annotations

import argparse
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.design import Design
from raycaster.errors import UserError
from raycaster.options import add_build_option, add_configuration_options, add_scene_argument
from raycaster.output import Console, check_replaceable, put, replaced
from raycaster.scene import find_scene
from raycaster.sim.job import Job
from raycaster.sim.simulator import (
    WINDOW_BENCH,
    Model,
    SimulationError,
    add_simulator_option,
    build_model,
    find_tool,
    run_bench,
)
from raycaster.waits import building

MARGIN = 32
"""Clocks after the last row's time, in which its last pixels reach the pins."""


def add_recording_options(parser: argparse.ArgumentParser, pixel: str) -> None:
    """Add the options that say what is recorded of which design.

    Args:
        parser: gets them.
        pixel: what `--pixel` is for.
    """
    add_scene_argument(parser, "what to record (mirror_room)", default=find_scene("mirror_room"))
    parser.add_argument("--pixel", metavar="COLUMN,ROW", help=pixel)
    add_simulator_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)


def pixel_place(text: str) -> tuple[int, int]:
    """Column and row, as they are given.

    Raises:
        UserError: they are not two numbers.
    """
    column, comma, row = text.partition(",")
    if not (comma and column.strip().isdecimal() and row.strip().isdecimal()):
        raise UserError(f"pixel: a column and a row of rays, as in 160,120, not {text}")
    return int(column), int(row)


def window_clocks(configuration: Configuration, first_row: int, last_row: int) -> tuple[int, int]:
    """When rows are computed and shown, in clocks since StartScreen: from the first, and before the second.

    A line buffer is filled while the row before is shown, and StartScreen comes a row's time before the first is.
    """
    row_cycles = configuration.screen_geometry.row_cycles
    first = first_row if configuration.facts.line_buffered else first_row + 1
    return first * row_cycles, (last_row + 2) * row_cycles + MARGIN


def check_rows(configuration: Configuration, rows: tuple[int, int]) -> None:
    """See that there are such rows.

    Raises:
        UserError: there are not.
    """
    (first, last), most = rows, configuration.screen_geometry.rows - 1
    if not 0 <= first <= last <= most:
        raise UserError(f"span: rows from 0 to {most}, the first one first, not {first},{last}")


def record(model: Model, design: Design, rows: tuple[int, int], target: Path) -> Path:
    """Simulate a scene's frame up to some rows, and write the waveform of these.

    Args:
        model: built for windows.
        design: the scene, and what the model is of.
        rows: the first and the last one, of rays.
        target: a directory, which is replaced once the waveform is whole; it also holds the simulation's log.

    Returns:
        The waveform.

    Raises:
        UserError: there are no such rows.
        SimulationError: the simulation failed.
    """
    check_rows(design.configuration, rows)
    begin, end = window_clocks(design.configuration, *rows)
    job = Job(design.configuration, scene=str(design.path.resolve()), reflections=design.reflections)
    with replaced(target) as filled:
        partial = filled.resolve()
        plusargs = (f"+window_file={partial / model.wave_file}", f"+window_from={begin}", f"+window_to={end}")
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
    design: Design, simulator: str, rows: tuple[int, int], target: Path, *, build: Path, console: Console
) -> Path:
    """Record some rows with a model that is built where there is none, telling a person what is being waited for.

    Args:
        design: the scene and what shows it.
        simulator: one of `SIMULATORS`.
        rows: the first and the last one, of rays.
        target: a directory; see `record`.
        build: the directory that holds `model/`.
        console: for the telling.

    Returns:
        The waveform.

    Raises:
        UserError: there are no such rows, or the simulator is missing.
        SimulationError: it could not build the model, or the simulation failed.
    """
    check_replaceable(target)
    find_tool(simulator)
    with console.waiting(
        f"building {design.configuration.name} with {simulator}", building(design.configuration.engine)
    ):
        model = build_model(design.configuration, simulator, build=build, bench=WINDOW_BENCH)
    with console.waiting("simulating"):
        return record(model, design, rows, target)
