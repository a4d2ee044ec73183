# SPDX-License-Identifier: MIT
"""Waveforms of some rows of a frame, which stay small however large the design is."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.design import Design
from raycaster.errors import UserError
from raycaster.verif.job import Job
from raycaster.verif.simulator import Model, SimulationError, run_bench

FILE = "waves.fst"

MARGIN = 32
"""Clocks after the last row's time, in which its last pixels reach the pins."""


def window_clocks(configuration: Configuration, first_row: int, last_row: int) -> tuple[int, int]:
    """When rows are computed and shown, in clocks since StartScreen: from the first, and before the second.

    A line buffer is filled while the row before is shown, and StartScreen comes a row's time before the first is.
    """
    row_cycles = configuration.screen_geometry.row_cycles
    first = first_row if configuration.engine != "beam" else first_row + 1
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
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = Path(tempfile.mkdtemp(prefix=f".{target.name}-", dir=target.parent)).resolve()
    begin, end = window_clocks(design.configuration, *rows)
    plusargs = (f"+window_file={partial / FILE}", f"+window_from={begin}", f"+window_to={end}")
    job = Job(design.configuration, scene=str(design.path.resolve()), reflections=design.reflections)
    try:
        run_bench(model, "raycaster.verif.wave_bench", job, partial, plusargs=plusargs)
        if not (partial / FILE).exists():
            raise SimulationError(f"{model.simulator} wrote no waveform; its log is {partial / 'sim.log'}")
    except SimulationError as error:
        failed = target.with_name(f"{target.name}-failed")
        shutil.rmtree(failed, ignore_errors=True)
        partial.rename(failed)
        raise SimulationError(str(error).replace(str(partial), str(failed))) from None
    partial.chmod(0o755)
    shutil.rmtree(target, ignore_errors=True)
    partial.rename(target)
    return target / FILE
