# SPDX-License-Identifier: MIT
"""Run a design in Verilator, as fast as possible: buttons or a driver's writes in, frames out."""

from __future__ import annotations

import shutil
import struct
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from raycaster.configuration import CHANNEL_BITS, Configuration, need_avalon
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import count_wrong, shown
from raycaster.memory_map import BUTTON_NAMES, PROGRAM_FILE, clocks_per_bit
from raycaster.registers import address_bits
from raycaster.sim.register_model import LiveScene, SceneFollower
from raycaster.sim.simulator import BUILD, SimulationError, build_program, convert

TOP = "machine"
BENCH, LOOP, MACHINE = (Path(__file__).with_name(f"{TOP}.{kind}") for kind in ("v", "cpp", "h"))
HOST = Path(__file__).with_name("host.h")
"""Header of loops that drive a design's bus."""

SIGNS = Path(__file__).with_name("signs.h")
"""Header that the compiler includes before a design."""

EVENT_WORDS = 8
"""Words of 32 bits that the loop writes for a clock's events."""

MOST_FRAMES = 60
"""Most frames to wait for a committed scene."""


@dataclass(frozen=True)
class Frame:
    """A system's outputs between two vertical syncs."""

    picture: np.ndarray
    """uint8 (lines, pixels, 3), as the monitor shows it; after reset the first frame may lack its beginning."""

    clocks: int
    busy: int
    """Clocks in which a picture was computed."""

    scene: LiveScene | None
    """Scene of this picture; None before the first StartScreen, and for a black picture without one."""

    text: str
    """Text from the serial port."""

    def wrong(self, config: Configuration) -> int:
        """Return the number of pixels that differ from exact arithmetic.

        Raises:
            SimulationError: the design shows no scene.
        """
        if self.scene is None:
            raise SimulationError("the design shows no scene")
        perfect = self.scene.picture(ExactModel(), config.screen_geometry)
        return count_wrong(self.picture, shown(perfect, config))


class Machine:
    """A running design; a context manager that ends it.

    Args:
        command: the command from `build_machine`.
        config: the design in it.
        program: the file for its processor, if it has one.
    """

    def __init__(self, command: Sequence[str], config: Configuration, program: Path | None = None):
        self._screen, self._lost_bits = config.screen_geometry, CHANNEL_BITS - config.colour_bits
        self._scenes = SceneFollower(config)
        self._directory = tempfile.TemporaryDirectory(prefix="raycaster-")
        if program:
            shutil.copyfile(program, Path(self._directory.name) / PROGRAM_FILE)
        self._process = subprocess.Popen(
            command, cwd=self._directory.name, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        assert self._process.stdin and self._process.stdout  # they are pipes
        self._input, self._output = self._process.stdin, self._process.stdout
        self.frame(0)  # the start-up frame, which the monitor sees only in part

    def __enter__(self) -> Machine:
        return self

    def __exit__(self, *_: object) -> None:
        self._input.close()
        self._process.wait()
        self._output.close()
        self._directory.cleanup()

    def frame(self, buttons: int = 0, writes: Sequence[tuple[int, int]] = ()) -> Frame:
        """Run to the next vertical sync.

        Args:
            buttons: the held buttons, one bit each; with a processor.
            writes: word addresses and words that a driver writes one after the other, from now on; without a processor.

        Raises:
            SimulationError: the simulation ended.
        """
        words = [buttons, len(writes), *(word for write in writes for word in write)]
        try:
            self._input.write(struct.pack(f"<{len(words)}I", *words))
            self._input.flush()
        except BrokenPipeError:
            raise SimulationError("the simulated system ended") from None
        clocks, busy, count, events, characters = struct.unpack("<5I", self._read(20))
        pixels = np.frombuffer(self._read(4 * count), dtype=np.uint8).reshape(-1, 4)[:, :3] << self._lost_bits
        width, height = self._screen.horizontal.visible, self._screen.vertical.visible
        picture = np.zeros((height * width, 3), dtype=np.uint8)
        shown = pixels[-height * width :]
        picture[len(picture) - len(shown) :] = shown
        words = np.frombuffer(self._read(4 * EVENT_WORDS * events), dtype="<u4").reshape(-1, EVENT_WORDS).tolist()
        for clock, start_screen, takes, again, written, address, data, lanes in words:
            # A write in StartScreen's clock is too late for it.
            if start_screen:
                self._scenes.start_screen(clock, takes=bool(takes), again=bool(again))
            if written:
                self._scenes.write(clock, address, data, lanes)
        text = self._read(characters).decode("ascii", "replace")
        return Frame(picture.reshape(height, width, 3), clocks, busy, self._scenes.shown, text)

    def show(self, writes: Sequence[tuple[int, int]]) -> Frame:
        """Run until the scene that a driver commits is shown; without lists of frames, that is the next frame.

        Raises:
            SimulationError: the simulation ended, or the scene is not shown within `MOST_FRAMES` frames.
        """
        for number in range(MOST_FRAMES):
            frame = self.frame(writes=() if number else writes)
            if self._scenes.shows_last:
                return frame
        raise SimulationError(f"a scene was not shown within {MOST_FRAMES} frames; do the lists hold its runs?")

    def _read(self, size: int) -> bytes:
        data = self._output.read(size)
        if len(data) != size:
            raise SimulationError("the simulated system ended")
        return data


@dataclass(frozen=True)
class MachineSources:
    """Files and options that a machine is compiled from."""

    name: str
    files: tuple[Path, ...]
    """Verilog files; the top module is `TOP`."""

    flags: tuple[str, ...]
    """Flags for Verilator."""

    defines: tuple[str, ...]
    """Flags for the compiler."""


def machine_sources(config: Configuration, build: Path = BUILD, *, processor: bool) -> MachineSources:
    """Convert a design; the arguments are those of `build_machine`.

    Raises:
        UserError: the configuration's bus is not Avalon-MM.
    """
    need_avalon(config, "the simulated machine")
    files = convert(config, build, system=processor)
    screen = config.screen_geometry
    flags = (
        # A table of constants would hide from the optimiser that the camera's rays have no mirror behind them.
        "-O3", "-fno-table", "--x-assign", "fast", "--x-initial", "fast", "--no-timing", "--noassert",
        "-Wno-lint", "-Wno-style",
        *((f"-DSYSTEM={files[-1].stem}",) if processor else ()),
        *(("-DWHOLE_FRAMES",) if config.facts.whole_frames else ()), f"-GBUTTONS={len(BUTTON_NAMES)}",
        f"-GCOLOUR_BITS={config.colour_bits * config.pixels}", f"-GADDRESS_BITS={address_bits(*config.map)}",
    )  # fmt: skip
    defines = (
        f"-DVS_ACTIVE={int(screen.vertical.active_high)}",
        f"-DPIXELS={config.pixels}",
        f"-DCOLOUR_BITS={config.colour_bits}",
        f"-DCLOCKS_PER_BIT={clocks_per_bit(screen.clock_hz) if processor else 0}",
    )
    name = f"{config.name}-{'processor' if processor else 'driven'}"
    return MachineSources(name, (*files, BENCH), flags, defines)


def build_machine(config: Configuration, build: Path = BUILD, *, processor: bool) -> list[str]:
    """Compile a design, or reuse the compiled one.

    Args:
        config: the design.
        build: the directory that holds `model/`.
        processor: True if a program drives it, False if the caller of `Machine.frame` does.

    Returns:
        The command that runs it, for `Machine`.

    Raises:
        UserError: Verilator, something that it needs, or PicoRV32 is missing.
        SimulationError: the design could not be compiled.
    """
    made_of = machine_sources(config, build, processor=processor)
    return build_program(
        made_of.name, TOP, made_of.files, [LOOP, MACHINE, HOST, SIGNS], build=build, flags=made_of.flags,
        compiler=("-O2", "-include", str(SIGNS), *made_of.defines),
    )  # fmt: skip
