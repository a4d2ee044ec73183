# SPDX-License-Identifier: MIT
"""Record a waveform of some rows of a scene's frame, and open it in a viewer: `make wave`."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from raycaster.convert.write import design_states
from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.ray import Ray
from raycaster.debug.recorder import add_recording_options, build_and_record, pixel_place
from raycaster.debug.wave_files import View, write_files
from raycaster.debug.waves import Waves
from raycaster.design.for_scene import Design
from raycaster.design.options import CommandParser, given_options
from raycaster.errors import UserError
from raycaster.fit.fixing import design_of
from raycaster.output import Console


def rows_of(text: str | None, row: int, count: int) -> tuple[int, int]:
    """Parse the first and the last of `count` rows; without a text, both are the pixel's row.

    Raises:
        UserError: the text is not one or two numbers, a row does not exist, or the rows leave out the pixel's.
    """
    if text is None:
        return row, row
    numbers = [number.strip() for number in text.split(",")]
    if len(numbers) > 2 or not all(number.isdecimal() for number in numbers):
        raise UserError(f"span: expected the first and the last row, as in 118,122, got {text}")
    first, last = int(numbers[0]), int(numbers[-1])
    if not first <= last < count:
        raise UserError(f"span: expected rows from 0 to {count - 1} in rising order, got {first},{last}")
    if not first <= row <= last:
        raise UserError(f"span: rows {first} to {last} do not include the pixel's row {row}")
    return first, last


def write_view(path: Path, design: Design, ray: Ray) -> Path:
    """Write files for GTKWave next to a waveform of a pixel's row, with the cursor at the pixel's ray."""
    waves = Waves(path)
    description = description_of(design.configuration, ray.unit)
    samples = waves.sample(description.controls())
    events = description.events(samples, ray)
    cycles = [event.cycle for event in events if event.kind != "shown"] or [0, len(samples.times_ns) - 1]
    begin, end = map(samples.begin_ns, (cycles[0], max(cycles)))
    view = View(description.groups(), design_states(design.configuration), begin, end)
    return write_files(waves, view)


def viewer(waves: Path, view: Path) -> list[str] | None:
    """Return the command that shows a waveform; None if there is no viewer or no screen."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return None
    commands = ["gtkwave", str(view)], ["surfer", str(waves)]
    return next((command for command in commands if shutil.which(command[0])), None)


def command_parser() -> CommandParser:
    """Make the command's parser."""
    parser = CommandParser("wave", __doc__, "boxes --pixel 160,120")
    add_recording_options(parser, "column and row of the ray at the cursor, from 0 (default: the middle)")
    parser.add_argument("--span", metavar="FIRST,LAST", help="first and last row to record (default: the pixel's row)")
    parser.add_argument("--no-viewer", action="store_true", help="do not open a viewer")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    console = Console(soft_wrap=True)
    design = design_of(arguments.scene, given_options(arguments), arguments.fix, console)
    screen = design.configuration.screen_geometry
    column, row = pixel_place(arguments.pixel or f"{screen.centre_column},{screen.rows // 2}")
    ray = Ray(design, row, column)
    description_of(design.configuration, ray.unit)  # refuses before anything is built
    rows = rows_of(arguments.span, row, screen.rows)
    target = arguments.build / "wave" / design.name
    waves = build_and_record(arguments, design, rows, target, console)
    if waves is None:
        return 1
    view = write_view(waves, design, ray)
    console.print(f"{waves}: rows {rows[0]} to {rows[1]}, {waves.stat().st_size / 1e6:.1f} MB")
    command = None if arguments.no_viewer else viewer(waves.resolve(), view)
    if command:
        with (waves.parent / "viewer.log").open("w") as log:
            subprocess.Popen(command, cwd=waves.parent, stdout=log, stderr=log, start_new_session=True)
        console.print(f"opened in {command[0]}")
        return 0
    console.print(f"to open it: gtkwave {shlex.quote(str(waves.parent / view.name))}")
    return 0
