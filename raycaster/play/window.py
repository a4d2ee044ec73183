# SPDX-License-Identifier: MIT
"""`raycaster play`: play the game, or walk through a scene, on the simulated hardware in a window."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.design.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    add_scene_argument,
    command_line,
    given_options,
)
from raycaster.errors import UserError, not_installed
from raycaster.memory_map import BUTTON_NAMES
from raycaster.output import Console
from raycaster.play.machine import Frame, Machine, build_machine
from raycaster.play.system import play_options
from raycaster.play.walk import TURNS, WALKS, Walker, design_to_walk
from raycaster.sim.simulator import SimulationError, announced
from raycaster.sw.firmware import build_firmware

GAME_KEYS = {"left": ("left", "a"), "right": ("right", "d"), "up": ("up", "w"), "down": ("down", "s")}
GAME_KEYS |= {"fire": ("space", "return")}
WALK_KEYS = {"forward": ("w",), "back": ("s",), "left": ("a",), "right": ("d",), "rise": ("e",), "sink": ("q",)}
TURN_KEYS = {"turn left": ("left",), "turn right": ("right",), "look up": ("up",), "look down": ("down",)}
"""Names of the keys that hold each button."""

LEAST_WIDTH = 960
"""Width in pixels up to which the window magnifies smaller pictures, by a whole factor."""

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
BAR = 28


class Judge:
    """Counts the pixels that differ from exact arithmetic, in as many pictures as there is time for.

    Args:
        config: the design that draws.
    """

    def __init__(self, config: Configuration):
        self._config = config
        self._pool = ThreadPoolExecutor(1)
        self._asked: Future[int] | None = None
        self.wrong: int | None = None
        """Wrong pixels in the last checked picture; None before the first."""
        self.pictures = self.all_wrong = 0
        """Number of checked pictures, and of all wrong pixels in them."""

    def look(self, frame: Frame) -> None:
        """Start checking a picture, unless the previous check is still running."""
        if self._asked is not None and not self._asked.done():
            return
        self.finish()
        if frame.scene is not None and frame.scene.run:
            self._asked = self._pool.submit(frame.wrong, self._config)

    def finish(self) -> None:
        """Wait for the running check."""
        if self._asked is not None:
            self.wrong, self._asked = self._asked.result(), None
            self.pictures += 1
            self.all_wrong += self.wrong


class Window:
    """A window with the magnified picture and a line of text below it; closing it or pressing Escape ends the loop."""

    def __init__(self, config: Configuration, title: str, keys: dict[str, tuple[str, ...]], buttons: Sequence[str]):
        pygame = self._pygame = _pygame()
        screen = config.screen_geometry
        width, height = screen.horizontal.visible, screen.vertical.visible
        times = max(1, LEAST_WIDTH // width)
        self._size = times * width, times * height
        try:
            # Without any of these SDL would draw nothing visible.
            if sys.platform == "linux" and not any(name in os.environ for name in DISPLAYS):
                raise pygame.error
            pygame.display.init()
            self._surface = pygame.display.set_mode((self._size[0], self._size[1] + BAR))
        except pygame.error:
            raise UserError(
                f"there is no display to open a window on; {command_line('game')} writes an animation instead"
            ) from None
        pygame.font.init()
        pygame.display.set_caption(title)
        self._font = pygame.font.Font(None, BAR - 6)
        self._keys = {pygame.key.key_code(key): buttons.index(button) for button, held in keys.items() for key in held}
        self._held: set[int] = set()
        self.drag = 0, 0
        """Pixels to the right and down that the mouse was dragged before the last call of `held`."""

    def held(self) -> int | None:
        """Return the held buttons, one bit each; None if the window is to close."""
        pygame = self._pygame
        self.drag = 0, 0
        for event in pygame.event.get():
            if event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE):
                return None
            if event.type == pygame.KEYDOWN and event.key in self._keys:
                self._held.add(event.key)
            elif event.type == pygame.KEYUP:
                self._held.discard(event.key)
            elif event.type == pygame.MOUSEMOTION and event.buttons[0]:
                self.drag = self.drag[0] + event.rel[0], self.drag[1] + event.rel[1]
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
        """Close the window."""
        self._pygame.quit()


def _pygame():
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        import pygame  # noqa: PLC0415 - only needed for a window
    except ImportError:
        raise UserError(not_installed("pygame", "play")) from None
    return pygame


def loop(
    play: Callable[[int], Frame],
    window: Window,
    judge: Judge,
    config: Configuration,
    say: Callable[[str], None],
    frames: int | None,
) -> tuple[int, float]:
    """Show frame after frame.

    Args:
        play: draws a frame while these buttons are held.
        window: shows the frames.
        judge: checks pictures on the way.
        config: the design.
        say: called with the text from the serial port.
        frames: number of frames, or None to go on until the window is closed.

    Returns:
        Number of frames, and frames per second.
    """
    started, count, rate = time.perf_counter(), 0, 0.0
    while (frames is None or count < frames) and (held := window.held()) is not None:
        before = time.perf_counter()
        frame = play(held)
        say(frame.text.replace("\r", ""))
        judge.look(frame)
        took = time.perf_counter() - before
        rate = 0.9 * rate + 0.1 / took if rate else 1 / took
        parts = [config.engine, f"{rate:.1f} frames/s", f"computes in {frame.busy:,} of {frame.clocks:,} clocks"]
        if judge.wrong is not None:
            parts += [f"{judge.wrong:,} pixels wrong"]
        window.show(frame.picture, "    ".join(parts))
        count += 1
    return count, count / (time.perf_counter() - started)


def walk_through(machine: Machine, walker: Walker, window: Window) -> Callable[[int], Frame]:
    """Load a walker's scene, and return a function that moves it for a frame while these buttons are held."""
    machine.frame(writes=walker.load())

    def play(held: int) -> Frame:
        walker.move([name for bit, name in enumerate(WALKS + TURNS) if held >> bit & 1], window.drag)
        return machine.frame(writes=walker.writes())

    return play


def command_parser() -> CommandParser:
    """Make the command's parser."""
    parser = CommandParser("play", __doc__, "")
    add_scene_argument(parser, "scene to walk through, instead of the game")
    parser.add_argument("--frames", type=int, help="number of frames (default: until the window is closed)")
    parser.add_argument("--screenshot", type=Path, metavar="PNG", help="file for the last picture in the window")
    add_build_option(parser)
    add_configuration_options(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    console = Console()
    options = given_options(arguments)
    if arguments.scene:
        design = design_to_walk(arguments.scene, options)
        config, program, walker = design.configuration, None, Walker(design.shown, design.configuration)
        keys = WALK_KEYS | (TURN_KEYS if config.turn else {})
        names: Sequence[str] = WALKS + TURNS
    else:
        config, walker = configure(**play_options(options)), None
        program = build_firmware((arguments.build / "firmware").absolute()).words
        keys, names = GAME_KEYS, BUTTON_NAMES

    judge = Judge(config)
    say = partial(console.print, end="")
    # Fail before anything is built if there can be no window.
    window = Window(config, "RayCaster", keys, names)
    try:
        for button, held in keys.items():
            console.print(f"{button}: {' or '.join(held)}")
        if walker and config.turn:
            console.print("turn and look: also drag with the mouse")
        with announced(console, f"building {config.name}", config.facts):
            command = build_machine(config, arguments.build, processor=walker is None)
        with Machine(command, config, program) as machine:
            play = walk_through(machine, walker, window) if walker else machine.frame
            count, rate = loop(play, window, judge, config, say, arguments.frames)
        judge.finish()
        if arguments.screenshot:
            window.save(arguments.screenshot)
    except SimulationError as error:
        raise UserError(str(error)) from None
    finally:
        window.close()
    # The serial port's text may stop within a line.
    console.print()
    console.print(
        f"{count} frames, {rate:.1f} per second; in {judge.pictures} of them, compared with exact arithmetic, "
        f"{judge.all_wrong:,} pixels are wrong",
        soft_wrap=True,
    )
