# SPDX-License-Identifier: MIT
"""The C sources of sw/, compiled for the host and connected to the model of the registers."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from raycaster.configuration import Configuration, configure
from raycaster.memory_map import BUTTON_NAMES
from raycaster.registers import register_map
from raycaster.scene import Basis
from raycaster.sim.register_model import LiveScene, RegisterFile, Request

ROOT = Path(__file__).parents[2]
SOFTWARE = ROOT / "sw"
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror")

GAME_HEADER = SOFTWARE / "game" / "game.h"
SEED = int(re.search(r"GAME_SEED = (\d+)", GAME_HEADER.read_text())[1])
EVENTS = {
    name: int(bit)
    for name, bit in re.findall(r"GAME_(STARTED|RETURNED|TILE|LEVEL|MISSED|ENDED) = (\d+)", GAME_HEADER.read_text())
}
FIRE = 1 << BUTTON_NAMES.index("fire")
CONFIG = configure(engine="exact", screen="tiny", rectangles=12)
"""Design whose registers the software is tested with."""

_Read = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_uint32)
_Write = ctypes.CFUNCTYPE(None, ctypes.c_uint32, ctypes.c_uint32)


class Point(ctypes.Structure):
    """`struct raycaster_point`."""

    _fields_ = [(axis, ctypes.c_uint16) for axis in "xyz"]


class Colour(ctypes.Structure):
    """`struct raycaster_colour`."""

    _fields_ = [(channel, ctypes.c_uint8) for channel in ("red", "green", "blue")]


class Status(ctypes.Structure):
    """`struct raycaster_status`."""

    _fields_ = [("frame", ctypes.c_uint16)] + [(name, ctypes.c_bool) for name in ("busy", "underrun", "bad_rectangle")]


class Cycles(ctypes.Structure):
    """`struct raycaster_cycles`."""

    _fields_ = [("row", ctypes.c_uint16), ("group", ctypes.c_uint16)]


class RayCaster(ctypes.Structure):
    """`struct raycaster`."""

    _fields_ = [
        ("base", ctypes.c_void_p),
        *((name, ctypes.c_uint16) for name in ("major", "minor", "units", "rows")),
        *(
            (name, ctypes.c_uint8)
            for name in (
                "rectangles", "reflections", "engine", "built_in", "scale", "fraction_bits", "divider_bits",
                "colour_bits",
            )
        ),
        *((name, ctypes.c_bool) for name in ("nearest", "turn", "materials", "patterns", "light")),
    ]  # fmt: skip


class Direction(ctypes.Structure):
    """`struct raycaster_vector`."""

    _fields_ = [(axis, ctypes.c_int16) for axis in "xyz"]


class Turned(ctypes.Structure):
    """`struct raycaster_basis`."""

    _fields_ = [(name, Direction) for name in ("forward", "right", "up")]

    @classmethod
    def of(cls, basis: Basis) -> Turned:
        """Convert from Python vectors."""
        return cls(*(Direction(*vector) for vector in basis))

    @property
    def basis(self) -> Basis:
        """The three vectors in Python."""
        return tuple(tuple(getattr(getattr(self, name), axis) for axis in "xyz") for name, _ in self._fields_)


class Vector(ctypes.Structure):
    """`struct game_vector`."""

    _fields_ = [(axis, ctypes.c_int32) for axis in "xyz"]


class GameRectangle(ctypes.Structure):
    """`struct game_rectangle`."""

    _fields_ = [("low", Point), ("high", Point), ("colour", Colour), ("enabled", ctypes.c_bool)]


class Game(ctypes.Structure):
    """`struct game`."""

    _fields_ = [
        ("phase", ctypes.c_int),
        ("attract", ctypes.c_bool),
        *((name, ctypes.c_uint8) for name in ("lives", "level", "tiles")),
        *(
            (name, ctypes.c_uint32)
            for name in ("score", "random", "age", "held", "sway", "racket_flash", "tile_flash", "alarm")
        ),
        *((name, Vector) for name in ("ball", "velocity", "racket", "target", "veil")),
        ("turn", ctypes.c_int32),
        ("drawn", ctypes.c_bool),
        ("shown_turn", ctypes.c_int32),
        ("camera", Point),
        ("shown", 12 * GameRectangle),
    ]


def enumerators(header: Path, name: str) -> list[str]:
    """Return the names in an enumeration of a header, whose values count from 0."""
    body = re.search(rf"enum {name} {{(.*?)}}", header.read_text(), re.S)[1]
    assert "=" not in body
    return re.findall(r"\w+", body)


def compile_library(directory: Path, *sources: str | Path) -> ctypes.CDLL:
    """Compile sources from sw/, or from elsewhere by absolute path, and load them."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    library = directory / "library.so"
    tests = Path(__file__).parent
    command = [
        compiler, *STRICT, "-O1", "-shared", "-fPIC", "-include", tests / "host_bus.h", f"-I{SOFTWARE}", "-o", library,
        tests / "host_bus.c", *(SOFTWARE / source for source in sources),
    ]  # fmt: skip
    subprocess.run(command, check=True)
    loaded = ctypes.CDLL(library)
    for function, result in (
        ("raycaster_error_text", ctypes.c_char_p),
        ("raycaster_get_status", Status),
        ("raycaster_get_cycles", Cycles),
        ("raycaster_frame", ctypes.c_uint16),
        ("raycaster_acknowledge", ctypes.c_bool),
        ("raycaster_is_committing", ctypes.c_bool),
        ("raycaster_turned", Turned),
    ):
        getattr(loaded, function).restype = result
    return loaded


class Registers:
    """Registers of a ray tracer, without the rest; StartScreen comes on demand.

    Attributes:
        file: the model.
        written: byte offsets and words of all writes, in order.
        polls_to_frame: reads of the pending interrupt until the next StartScreen, or None for never.
    """

    def __init__(self, config: Configuration):
        self.file = RegisterFile(config)
        self.written: list[tuple[int, int]] = []
        self.polls_to_frame: int | None = None
        self._pending = 4 * register_map(config.rectangles)["irq_pending"].address
        self.file.clock(True, None)

    def read(self, offset: int) -> int:
        """Read the word at an offset in bytes."""
        assert offset % 4 == 0
        if offset == self._pending and self.polls_to_frame is not None:
            self.polls_to_frame -= 1
            if self.polls_to_frame == 0:
                self.polls_to_frame = None
                self.start_screen()
        self._request(Request(offset // 4))
        return self.file.agent.answer[1]

    def write(self, offset: int, word: int) -> None:
        """Write a word at an offset in bytes."""
        assert offset % 4 == 0
        self.written.append((offset, word))
        self._request(Request(offset // 4, word))

    def _request(self, request: Request) -> None:
        while not self.file.clock(False, request):
            pass
        # One clock to answer or to write, and one for a commit's copy.
        self.file.clock(False, None)
        answer = self.file.agent.answer
        self.file.clock(False, None)
        self.file.agent.answer = answer

    def start_screen(self) -> LiveScene:
        """Let StartScreen come now; return the live scene."""
        self.file.clocks = self.file.start_screen_clock
        self.file.clock(False, None)
        return self.file.live

    def say(self, register: str, **fields: int) -> None:
        """Change what some fields of a read-only register return."""
        words, known = self.file.agent._constants, self.file.agent.registers[register]
        words[register] = known.pack(**{**known.unpack(words[register]), **fields})


@contextmanager
def attached(library: ctypes.CDLL, registers: Registers) -> Iterator[None]:
    """Connect the driver in a library to registers."""

    class HostBus(ctypes.Structure):
        _fields_ = [("read", _Read), ("write", _Write)]

    bus = HostBus.in_dll(library, "host_bus")
    bus.read, bus.write = _Read(registers.read), _Write(registers.write)
    yield


def probed(library: ctypes.CDLL) -> RayCaster:
    """Return the handle of the attached device."""
    device = RayCaster()
    assert library.raycaster_probe(ctypes.byref(device), None) == 0
    return device


class Frame(NamedTuple):
    """Results of a step: events, the scene that is live afterwards, and the writes for it."""

    events: set[str]
    live: LiveScene
    written: list[tuple[int, int]]


class Session:
    """A game and its ray tracer."""

    def __init__(self, library: ctypes.CDLL, seed: int = SEED, config: Configuration = CONFIG):
        self.software = library
        self.game = Game()
        self.registers = Registers(config)
        with attached(library, self.registers):
            self.device = probed(library)
            library.raycaster_set_run(ctypes.byref(self.device), True)
            assert library.raycaster_set_reflections(ctypes.byref(self.device), 1) == 0
        library.game_init(ctypes.byref(self.game), seed)

    def draw(self) -> int:
        """Draw; return the driver's error."""
        with attached(self.software, self.registers):
            return self.software.game_draw(ctypes.byref(self.game), ctypes.byref(self.device))

    def step(self, buttons: int) -> set[str]:
        """Run a frame with these buttons, without drawing; return its events."""
        bits = self.software.game_step(ctypes.byref(self.game), buttons)
        return {name for name, bit in EVENTS.items() if bits & bit}

    def autoplay(self) -> int:
        """Return the buttons that a good player would hold now."""
        return self.software.game_autoplay(ctypes.byref(self.game))

    def play(self, script: Iterable[int]) -> Iterator[Frame]:
        """Play, draw and show frame after frame; the sticky errors must stay clear."""
        for buttons in script:
            self.registers.written.clear()
            events = self.step(buttons)
            assert self.draw() == 0
            written = list(self.registers.written)
            with attached(self.software, self.registers):
                assert self.software.raycaster_commit(ctypes.byref(self.device)) == 0
                live = self.registers.start_screen()
                assert self.software.raycaster_check(ctypes.byref(self.device)) == 0
            yield Frame(events, live, written)

    def start(self) -> None:
        """Press fire in attract mode."""
        assert self.step(FIRE) == {"STARTED"}

    def phase(self) -> str:
        """Return the name of the phase in `enum game_phase`."""
        return enumerators(GAME_HEADER, "game_phase")[self.game.phase].removeprefix("GAME_")
