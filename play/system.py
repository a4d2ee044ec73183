# SPDX-License-Identifier: MIT
"""`python -m raycaster.play.system`: run a program on the simulated system with a processor, and check every pixel."""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.memory_map import BUTTON_NAMES, MEMORY_WORDS, PROGRAM_FILE, held_bits
from raycaster.options import add_configuration_options, given_options, run_command
from raycaster.output import Console, emptied, printable
from raycaster.sim.job import Job
from raycaster.sim.simulator import (
    BUILD,
    SYSTEM_BENCH,
    Model,
    SimulationError,
    add_simulator_option,
    build_model,
    run_bench,
)

FASTEST = {"engine": "beam", "screen": "play"}
"""Default options of a system with a processor: the configuration that simulates fastest."""


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


def read_buttons(text: str) -> list[int]:
    """Parse the buttons held in each frame: names joined by `+`, with `*` and a number of frames, separated by commas.

    Raises:
        UserError: a part is not understood.
    """
    frames: list[int] = []
    for part in text.split(","):
        names, _, times = part.strip().partition("*")
        held = [name for name in names.split("+") if name not in ("", "none")]
        if not set(held) <= set(BUTTON_NAMES) or not (times or "1").isdecimal():
            known = ", ".join(BUTTON_NAMES)
            raise UserError(f"buttons: {part!r} is not understood; an example is none*5,left+fire*20, of {known}")
        frames += [held_bits(held)] * int(times or "1")
    return frames


def main() -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.play.system", description=__doc__)
    parser.add_argument("program", type=Path, help="file of 32-bit words in hexadecimal, from address 0 on")
    parser.add_argument(
        "--buttons", default="none*4", help="buttons held in each frame, as in none*5,left+fire*20 (default: none*4)"
    )
    add_simulator_option(parser)
    parser.add_argument("--output", type=Path, default=Path("build/play"), help="output folder (default: %(default)s)")
    add_configuration_options(parser)
    arguments = parser.parse_args()
    check_program(arguments.program)
    buttons = read_buttons(arguments.buttons)
    configuration = configure(**FASTEST | given_options(arguments))
    try:
        model = build_model(configuration, arguments.simulator, build=BUILD, bench=SYSTEM_BENCH)
        result = play(model, arguments.program, buttons, arguments.output)
    except SimulationError as error:
        print(printable(error), file=sys.stderr)
        return 1
    print(printable((arguments.output / "uart.txt").read_text(errors="replace"), lines=True), end="")
    rate = result["clocks_a_second"]
    speed = rate / configuration.screen_geometry.frame_cycles
    Console().print(
        f"{configuration.name}: {result['frames']} frames, {result['shown']} of them with a scene, "
        f"{result['wrong']:,} wrong pixels; "
        f"{rate:,} clocks and {speed:.2f} frames per second; pictures in {arguments.output}/",
        soft_wrap=True,
    )
    return 0


if __name__ == "__main__":
    run_command(main)
