# SPDX-License-Identifier: MIT
"""`python -m raycaster.verif.window`: the simulated hardware in a window: the game, or a scene to walk through."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
from rich.console import Console

from raycaster.configuration import WORLD_SIZE, Configuration, configure
from raycaster.design import design_for
from raycaster.errors import UserError
from raycaster.golden import exact
from raycaster.golden.picture import count_wrong, shown
from raycaster.memory_map import BUTTON_NAMES
from raycaster.options import add_configuration_options, given_options, run_command
from raycaster.rtl import scene_player
from raycaster.rtl.camera_axis import STEP
from raycaster.scene import Scene
from raycaster.sw.firmware import build_firmware
from raycaster.verif.machine import Frame, Machine, build_machine
from raycaster.verif.play import FASTEST
from raycaster.verif.simulator import BUILD, SimulationError

GAME_KEYS = {"left": ("left", "a"), "right": ("right", "d"), "up": ("up", "w"), "down": ("down", "s")}
GAME_KEYS |= {"fire": ("space", "return")}
SCENE_KEYS = {"forward": ("w",), "back": ("s",), "left": ("left", "a"), "right": ("right", "d")}
SCENE_KEYS |= {"up": ("up",), "down": ("down",)}
"""By button, the names of the keys that hold it."""

LEAST_WIDTH = 960
"""Of the window: smaller pictures are shown so many times larger."""

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
BAR = 28
MOVES = {"forward": (0, STEP), "back": (0, -STEP), "left": (1, -STEP), "right": (1, STEP)}
MOVES |= {"up": (2, STEP), "down": (2, -STEP)}
"""By button, the camera's axis and its step; see `scene_player.BUTTONS`."""

SETTLED = 3
"""Frames without a move after which a picture is surely one from where the camera is."""


class Walk:
    """Where the camera is, and what is wrong with the picture once it stands still.

    Args:
        scene: with the camera's first place.
        config: the design that draws it.
    """

    def __init__(self, scene: Scene, config: Configuration):
        self._scene, self._config = scene, config
        self.camera = scene.camera.position
        """Of the picture that comes next."""
        self._pool = ThreadPoolExecutor(1)
        self._asked: Future[int] | None = None
        self._still = 0
        self.wrong: int | None = None
        """Pixels that are not those of rational arithmetic; None: not known."""

    def follow(self, held: int, frame: Frame) -> None:
        """Look at a frame, and move as the hardware does for the buttons that were held at its StartScreen."""
        if self._asked and self._asked.done():
            self.wrong, self._asked = self._asked.result(), None
        camera = list(self.camera)
        pressed = {name for bit, name in enumerate(scene_player.BUTTONS) if held >> bit & 1}
        for name in pressed:
            axis, step = MOVES[name]
            alone = not any(other != name and MOVES[other][0] == axis for other in pressed)
            if alone and 0 <= camera[axis] + step < WORLD_SIZE:
                camera[axis] += step
        if tuple(camera) != self.camera:
            self.camera, self._still, self.wrong, self._asked = tuple(camera), 0, None, None
            return
        self._still += 1
        # The first frame after a move still comes, and a picture takes the processor a while.
        if self._still == SETTLED and self._asked is None:
            self._asked = self._pool.submit(self._count, frame.picture, self.camera)

    def _count(self, picture: np.ndarray, camera: tuple[int, int, int]) -> int:
        scene = self._scene.model_copy(update={"camera": self._scene.camera.model_copy(update={"position": camera})})
        perfect = exact.render(scene, self._config.screen_geometry, reflections=scene.reflections)
        return count_wrong(picture, shown(perfect, self._config))


class Window:
    """The picture, magnified, with a line of text below it. Closing it, or Escape, ends."""

    def __init__(self, config: Configuration, title: str, keys: dict[str, tuple[str, ...]], buttons: Sequence[str]):
        pygame = self._pygame = _pygame()
        screen = config.screen_geometry
        width, height = screen.horizontal.visible, screen.vertical.visible
        times = max(1, LEAST_WIDTH // width)
        self._size = times * width, times * height
        try:
            # Without any of these SDL would draw where nobody sees it.
            if sys.platform == "linux" and not any(name in os.environ for name in DISPLAYS):
                raise pygame.error
            pygame.display.init()
            self._surface = pygame.display.set_mode((self._size[0], self._size[1] + BAR))
        except pygame.error:
            raise UserError("there is no display to open a window on; make game writes an animation instead") from None
        pygame.font.init()
        pygame.display.set_caption(title)
        self._font = pygame.font.Font(None, BAR - 6)
        self._keys = {pygame.key.key_code(key): buttons.index(button) for button, held in keys.items() for key in held}
        self._held: set[int] = set()

    def held(self) -> int | None:
        """The buttons that are held, a bit each; None where the window is to close."""
        pygame = self._pygame
        for event in pygame.event.get():
            if event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE):
                return None
            if event.type == pygame.KEYDOWN and event.key in self._keys:
                self._held.add(event.key)
            elif event.type == pygame.KEYUP:
                self._held.discard(event.key)
        return sum({1 << self._keys[key] for key in self._held})

    def show(self, picture: np.ndarray, text: str) -> None:
        """Draw a frame."""
        pygame = self._pygame
        drawn = pygame.surfarray.make_surface(picture.swapaxes(0, 1))
        self._surface.blit(pygame.transform.scale(drawn, self._size), (0, 0))
        self._surface.fill("black", (0, self._size[1], self._size[0], BAR))
        self._surface.blit(self._font.render(text, True, "white"), (8, self._size[1] + 5))
        pygame.display.flip()

    def save(self, path: Path) -> None:
        """Write what the window shows as a PNG."""
        self._pygame.image.save(self._surface, str(path))

    def close(self) -> None:
        """Close it."""
        self._pygame.quit()


def _pygame():
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        import pygame  # noqa: PLC0415 - wanted only where a window is
    except ImportError:
        raise UserError("pygame is missing; pip install 'raycaster[play]'") from None
    return pygame


def loop(
    machine: Machine, window: Window, config: Configuration, watch: Callable[[int, Frame], str], frames: int | None
) -> tuple[int, float]:
    """Show frame after frame.

    Args:
        machine: what draws.
        window: what shows.
        config: the design.
        watch: told the buttons and each frame; returns what is to be said of its error.
        frames: after which it ends, or None to go on until the window is closed.

    Returns:
        Frames, and those a second.
    """
    started, count, rate = time.perf_counter(), 0, 0.0
    while (frames is None or count < frames) and (held := window.held()) is not None:
        before = time.perf_counter()
        frame = machine.frame(held)
        said = watch(held, frame)
        took = time.perf_counter() - before
        rate = 0.9 * rate + 0.1 / took if rate else 1 / took
        text = f"{config.engine} engine    {rate:.1f} frames a second    {frame.clocks:,} clocks a frame    {said}"
        window.show(frame.picture, text)
        count += 1
    return count, count / (time.perf_counter() - started)


def main(argv: Sequence[str] | None = None) -> None:
    """The command.

    Args:
        argv: its arguments, those of the process by default.
    """
    parser = argparse.ArgumentParser(prog="python -m raycaster.verif.window", description=__doc__.splitlines()[0])
    parser.add_argument("--scene", type=Path, metavar="PATH", help="walk through this scene instead of the game")
    parser.add_argument("--frames", type=int, help="end after so many (default: when the window is closed)")
    parser.add_argument("--screenshot", type=Path, metavar="PNG", help="write what the window showed last")
    parser.add_argument("--build", type=Path, default=BUILD, metavar="DIR", help="(default: %(default)s)")
    add_configuration_options(parser)
    arguments = parser.parse_args(argv)
    console = Console()
    options = given_options(arguments)
    if arguments.scene:
        design = design_for(arguments.scene, options, FASTEST)
        config, scene, program = design.configuration, design.shown, None
        keys, names, walk = SCENE_KEYS, scene_player.BUTTONS, Walk(scene, config)
    else:
        config, scene = configure(**FASTEST | options), None
        program = build_firmware((arguments.build / "firmware").absolute()).words
        keys, names, walk = GAME_KEYS, BUTTON_NAMES, None

    def watch(held: int, frame: Frame) -> str:
        if walk is None:
            console.print(frame.text, end="", highlight=False, markup=False)
            return ""
        walk.follow(held, frame)
        return "" if walk.wrong is None else f"{walk.wrong:,} pixels unlike exact arithmetic"

    # A window that cannot be opened is known before anything is built.
    window = Window(config, "RayCaster", keys, names)
    try:
        for button, held in keys.items():
            console.print(f"{button}: {' or '.join(held)}", highlight=False)
        with console.status(f"building {config.name}"):
            executable = build_machine(config, scene, arguments.build)
        with Machine(executable, config, program) as machine:
            count, rate = loop(machine, window, config, watch, arguments.frames)
        if arguments.screenshot:
            window.save(arguments.screenshot)
    except SimulationError as error:
        raise UserError(str(error)) from None
    finally:
        window.close()
    console.print(f"{count} frames, {rate:.1f} a second", highlight=False)


if __name__ == "__main__":
    run_command(main)
