# SPDX-License-Identifier: MIT
"""`raycaster game`: film a recorded game, or a scene with a moving light or camera, and check every pixel."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from PIL import Image
from rich.progress import Progress, track

from raycaster.configuration import WORLD_SIZE
from raycaster.convert.digest import verilog_digest
from raycaster.design.decide import configure
from raycaster.design.for_scene import Design
from raycaster.design.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    add_scene_argument,
    given_options,
)
from raycaster.errors import UserError
from raycaster.output import Console, Table, emptied, printable
from raycaster.play.machine import Machine, build_machine
from raycaster.play.system import play, play_options
from raycaster.play.walk import Walker, design_to_walk
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.scene import Light
from raycaster.sim.contact_sheet import write_contact_sheet
from raycaster.sim.simulator import SYSTEM_BENCH, SimulationError, announced, build_model
from raycaster.sw.firmware import build_firmware
from raycaster.sw.play_script import DEMO, load

FRAMES = 240
ANIMATION = "game.webp"
SHOWN_HZ = 30
"""Pictures per second of the animation: half the rate of the monitor, which browsers keep up with."""

SHEET = "sheet.png"
SHEET_COLUMNS = 3
SHEET_FRAMES = 9
"""Frames of the game on the sheet, evenly spread."""

CIRCLE = 60
"""Smallest radius of a light's circle around the middle of the world, in world units."""

LOOK = 35
"""Degrees that the camera turns to each side."""

POLL_SECONDS = 0.5


def write_animation(frames: list[Path], path: Path) -> None:
    """Write pictures as a lossless, repeating WebP animation."""
    first, *others = (Image.open(frame) for frame in frames)
    first.save(path, save_all=True, append_images=others, duration=1000 // SHOWN_HZ, loop=0, lossless=True)


def film_scene(design: Design, frames: int, build: Path, output: Path, console: Console) -> int:
    """Move a scene's light around the room, or turn its camera to both sides and back, and write each frame.

    Args:
        design: the scene, and the hardware that draws it.
        frames: number of frames, after which the motion repeats.
        build: the directory that holds `model/`.
        output: the output directory, replaced; gets `frame_*.png`.
        console: for the progress bar.

    Returns:
        Number of pixels in all frames that differ from exact arithmetic.

    Raises:
        SimulationError: the design could not be compiled, or shows no scene.
    """
    config, scene, wrong = design.configuration, design.shown, 0
    walker, light = Walker(scene, config), scene.light
    yaws = [LOOK * math.sin(2 * math.pi * number / frames) for number in range(frames + 1)]
    command = build_machine(config, build, processor=False)
    emptied(output)
    with Machine(command, config) as machine:
        machine.show(walker.load())
        for number in track(range(frames), "frames", console=console, transient=True):
            if light:
                walker.light = circling(light, (number + 1) / frames)
            else:
                walker.turn(yaws[number + 1] - yaws[number])
            frame = machine.show(walker.writes())
            wrong += frame.wrong(config)
            Image.fromarray(frame.picture).save(output / f"frame_{number:04}.png")
    return wrong


def circling(light: Light, turns: float) -> Light:
    """Return a light that has moved on a level circle around the middle of the world.

    Args:
        light: where the circle begins, at least `CIRCLE` from the middle; the world clips it.
        turns: how far it has come, in whole turns.
    """
    middle, last = WORLD_SIZE / 2, WORLD_SIZE - 1
    x, y, z = light.position
    radius = max(CIRCLE, math.hypot(x - middle, y - middle))
    angle = math.atan2(y - middle, x - middle) + 2 * math.pi * turns
    x, y = (max(0, min(last, round(middle + radius * part))) for part in (math.cos(angle), math.sin(angle)))
    return light.model_copy(update={"position": (x, y, z)})


def command_parser() -> CommandParser:
    """Make the command's parser."""
    parser = CommandParser("game", __doc__, "--frames 24")
    add_scene_argument(
        parser,
        "scene to film instead of the game, with a light that circles, or else a camera that looks to both sides",
    )
    parser.add_argument("--script", type=Path, default=DEMO, help="buttons held in each frame (default: %(default)s)")
    parser.add_argument("--frames", type=int, default=FRAMES, help="largest number of frames (default: %(default)s)")
    add_build_option(parser)
    parser.add_argument("--output", type=Path, help="directory for frames and animation (default: below --build)")
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that draws the frames, without the processor's."""
    if arguments.scene:
        return verilog_digest(design_to_walk(arguments.scene, given_options(arguments)).configuration)
    return verilog_digest(configure(**play_options(given_options(arguments))))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    if arguments.frames < 1:
        raise UserError(f"frames: expected at least 1, got {arguments.frames}")
    return _film_scene(arguments) if arguments.scene else _film_game(arguments)


def _film_scene(arguments: argparse.Namespace) -> int:
    console = Console()
    design = design_to_walk(arguments.scene, given_options(arguments))
    if not design.configuration.turn and not design.scene.light:
        raise UserError("turn: expected 1, as the camera must turn, got 0")
    output = arguments.output or arguments.build / "look" / design.name
    try:
        wrong = film_scene(design, arguments.frames, arguments.build, output, console)
    except SimulationError as error:
        raise UserError(str(error)) from None
    write_animation(sorted(output.glob("frame_*.png")), output / ANIMATION)
    screen = design.configuration.screen_geometry
    figures = {"frames": arguments.frames, "pixels": arguments.frames * screen.columns * screen.rows, "wrong": wrong}
    keep(arguments, figures, verilog)
    console.print(
        f"{design.configuration.name}: {arguments.frames} frames, {wrong:,} pixels differ from exact arithmetic; "
        f"{output / ANIMATION}, and each frame next to it",
        soft_wrap=True,
    )
    return int(wrong > 0)


def _film_game(arguments: argparse.Namespace) -> int:
    buttons = load(arguments.script)[: arguments.frames]
    configuration = configure(**play_options(given_options(arguments)))
    console = Console()
    build, output = arguments.build, arguments.output or arguments.build / "game"
    firmware = build_firmware((build / "firmware").absolute())
    try:
        with announced(console, f"building {configuration.name} with a processor", configuration.facts):
            model = build_model(configuration, "verilator", build=build, bench=SYSTEM_BENCH)
        with Progress(console=console, transient=True) as bars, ThreadPoolExecutor(1) as pool:
            bar = bars.add_task("frames", total=len(buttons))
            future = pool.submit(play, model, firmware.words, buttons, output)
            while not future.done():
                bars.update(bar, completed=len(list(output.glob("frame_*.png"))))
                time.sleep(POLL_SECONDS)
        result = future.result()
    except SimulationError as error:
        print(printable(error), file=sys.stderr)
        return 1
    frames = sorted(output.glob("frame_*.png"))
    write_animation(frames, output / ANIMATION)
    step = max(1, len(frames) // SHEET_FRAMES)
    write_contact_sheet(frames[step - 1 :: step][:SHEET_FRAMES], output / SHEET, SHEET_COLUMNS)
    console.print((output / "uart.txt").read_text(errors="replace"), end="")
    rate = result["clocks_a_second"]
    table = Table("design", "frames", "with a scene", "shown again", "wrong pixels", "clocks/s", "frames/s")
    speed = rate / configuration.screen_geometry.frame_cycles
    counts = (result[name] for name in ("frames", "shown", "again", "wrong"))
    table.add_row(configuration.name, *counts, rate, f"{speed:.2f}")
    console.print(table)
    figures = {key: result[key] for key in ("frames", "pixels", "wrong")} | {"frames_a_second": round(speed, 2)}
    keep(arguments, figures, verilog)
    console.print(f"{output / ANIMATION}, and next to it each frame and {SHEET}")
    return 0
