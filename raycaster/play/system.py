# SPDX-License-Identifier: MIT
"""Run a program on the simulated system with a processor, and check every pixel."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from raycaster.errors import UserError
from raycaster.memory_map import MEMORY_WORDS, PROGRAM_FILE
from raycaster.output import emptied
from raycaster.sim.job import Job
from raycaster.sim.simulator import Model, run_bench

FASTEST = {"engine": "span", "screen": "play", "units": 3}
"""Default options of a design that is played with: of all designs, it simulates the most pictures per second."""


def play_options(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of a design that is played with: those given, and `FASTEST` unless another engine is given."""
    defaults = FASTEST if given.get("engine", FASTEST["engine"]) == FASTEST["engine"] else {}
    return {**defaults, **given}


def play(model: Model, program: Path, buttons: Sequence[int], output: Path) -> dict[str, Any]:
    """Run a program from reset on, for one frame per entry of `buttons`.

    Args:
        model: a model with `SYSTEM_BENCH`.
        program: the file of its words, in hexadecimal.
        buttons: the buttons held from each frame's vertical sync on, one bit each, as in `memory_map.BUTTON_NAMES`.
        output: the output directory, replaced; gets `frame_*.png`, `uart.txt`, `result.json` and the simulation's log.

    Returns:
        The contents of `result.json`.

    Raises:
        UserError: the program is not a list of words, or does not fit the memory.
        SimulationError: a pixel is wrong, a row was late, the processor halted, or the video departs from the standard.
    """
    check_program(program)
    emptied(output)
    shutil.copyfile(program, output / PROGRAM_FILE)
    job = Job(model.configuration, output=str(output.resolve()), buttons=tuple(buttons))
    run_bench(model, "raycaster.play.game_bench", job, output)
    return json.loads((output / "result.json").read_text())


def check_program(program: Path) -> None:
    """Check that the memory can be loaded from a file.

    Raises:
        UserError: it cannot.
    """
    try:
        words = [int(word, 16) for word in program.read_text().split()]
    except (OSError, ValueError) as error:
        raise UserError(f"{program}: expected words in hexadecimal, one per line: {error}") from None
    if len(words) > MEMORY_WORDS or not all(0 <= word < 1 << 32 for word in words):
        raise UserError(f"{program}: expected at most {MEMORY_WORDS} words of 32 bits, got {len(words)}")
