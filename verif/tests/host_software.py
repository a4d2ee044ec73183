# SPDX-License-Identifier: MIT
"""The C sources of sw/, compiled for the host and connected to the model of the registers."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from conftest import ROOT

from raycaster.configuration import Configuration, configure
from raycaster.memory_map import BUTTON_NAMES
from raycaster.registers import register_map
from raycaster.scene import Basis
from raycaster.sim.register_model import LiveScene, RegisterFile, Request

SOFTWARE = ROOT / "sw"
COMPILER = shutil.which("gcc") or shutil.which("cc")
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror")

ON_HOST_BUS = ("-fcommon", "-include", Path(__file__).with_name("host_bus.h"))
"""Flags that connect the driver to `attached` registers."""

DRIVER_HEADER, GAME_HEADER = SOFTWARE / "raycaster.h", SOFTWARE / "game" / "game.h"
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

_NUMBERS = {"bool": ctypes.c_bool, "int": ctypes.c_int, "unsigned": ctypes.c_uint, "void": None} | {
    f"{sign}int{bits}_t": getattr(ctypes, f"c_{sign}int{bits}") for sign in ("", "u") for bits in (8, 16, 32)
}


def enumerators(header: Path, name: str) -> list[str]:
    """Return the names in an enumeration of a header, whose values count from 0."""
    body = re.search(rf"enum {name} {{(.*?)}}", header.read_text(), re.S)[1]
    assert "=" not in body
    return re.findall(r"\w+", body)


Error = IntEnum(
    "Error", [name.removeprefix("RAYCASTER_") for name in enumerators(DRIVER_HEADER, "raycaster_error")], start=0
)


class Header:
    """Types of the headers in sw/, as ctypes."""

    def __init__(self, *paths: Path):
        self._text = re.sub(r"//.*", "", "".join(path.read_text() for path in paths))
        self._structures: dict[str, type[ctypes.Structure]] = {}
        self._lengths = {"GAME_RECTANGLES": CONFIG.rectangles}
        for name, body in re.findall(r"^struct (\w+) {(.*?)^};", self._text, re.M | re.S):
            members = re.findall(r"([\w ]+[ *])(\w+)(?:\[(\w+)\])?;", body)
            fields = [
                (member, self._type(kind) * self._lengths[length] if length else self._type(kind))
                for kind, member, length in members
            ]
            self._structures[name] = type(name, (ctypes.Structure,), {"_fields_": fields})

    def __getitem__(self, name: str) -> type[ctypes.Structure]:
        return self._structures[name]

    def _type(self, text: str) -> type | None:
        *_, name = re.findall(r"\w+", text)
        if "*" in text:
            return ctypes.c_char_p if name == "char" else ctypes.POINTER(self._type(name))
        return ctypes.c_int if "enum" in text else self._structures.get(name) or _NUMBERS[name]

    def declare(self, library: ctypes.CDLL) -> None:
        """Give a library's functions the types in their prototypes, so that arguments are converted as in C."""
        for kind, name, arguments in re.findall(r"^(\w[\w ]+[ *])(\w+)\(([^)]*)\);", self._text, re.M):
            if hasattr(library, name):
                function = getattr(library, name)
                function.argtypes = [self._type(re.sub(r"\w+$", "", one)) for one in arguments.split(",")]
                function.restype = Error if "enum raycaster_error" in kind else self._type(kind)


HEADER = Header(DRIVER_HEADER, GAME_HEADER)
RayCaster, Game = HEADER["raycaster"], HEADER["game"]


def basis_of(turned: ctypes.Structure) -> Basis:
    """Convert a basis from C."""
    return tuple(tuple(getattr(getattr(turned, name), axis) for axis in "xyz") for name, _ in turned._fields_)


def compile_library(directory: Path, *sources: str | Path, flags: Sequence[str | Path] = ON_HOST_BUS) -> ctypes.CDLL:
    """Compile sources from sw/, or from elsewhere by absolute path, and load them."""
    library = directory / "library.so"
    command = [COMPILER, *STRICT, "-O1", "-shared", "-fPIC", f"-I{SOFTWARE}", "-o", library, *flags]
    subprocess.run([*command, *(SOFTWARE / source for source in sources)], check=True)
    loaded = ctypes.CDLL(library)
    HEADER.declare(loaded)
    return loaded


class Registers:
    """Registers of a ray tracer, without the rest; StartScreen comes on demand.

    Attributes:
        file: the model.
        written: byte offsets and words of all writes, in order.
        polls_to_frame: reads of the pending interrupt until the next StartScreen, or None for never.
    """

    def __init__(self, config: Configuration, **said: dict[str, int]):
        """Make the registers of a design; some read-only registers say something else than the design's facts."""
        self.file = RegisterFile(config)
        self.written: list[tuple[int, int]] = []
        self.polls_to_frame: int | None = None
        self._pending = 4 * register_map(config.rectangles)["irq_pending"].address
        self.file.clock(True, None)
        words, known = self.file.agent._constants, self.file.agent.registers
        for name, fields in said.items():
            words[name] = known[name].pack(**known[name].unpack(words[name]) | fields)

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


class HostBus(ctypes.Structure):
    """The functions in `host_bus.h` through which the driver reads and writes registers."""

    _fields_ = [("read", _Read), ("write", _Write)]


class Device:
    """A ray tracer's registers, and the driver's functions for them, without prefix and handle.

    Attributes:
        handle: the driver's handle.
        found: result of the probe.
        errors: results of calls that failed, in order.
    """

    def __init__(self, library: ctypes.CDLL, registers: Registers):
        self.registers = registers
        self.handle = RayCaster()
        self.errors: list[Error] = []
        self._library = library
        self._functions = _Read(registers.read), _Write(registers.write)
        self.found: Error = self.probe(None)

    def call(self, function: str, *arguments: Any) -> Any:
        """Call any function of the library with the driver connected to these registers; tuples become structures."""
        bus = HostBus.in_dll(self._library, "host_bus")
        bus.read, bus.write = self._functions
        called = getattr(self._library, function)
        kinds = called.argtypes or ()
        given = [
            getattr(kind, "_type_", kind)(*one) if isinstance(one, tuple) else one
            for kind, one in zip(kinds, arguments, strict=True)
        ]
        result = called(*given)
        if isinstance(result, Error) and result != Error.OK:
            self.errors.append(result)
        return result

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return partial(self.call, f"raycaster_{name}", self.handle)

    def shown(self) -> LiveScene:
        """Commit, and return what is live from the next frame on."""
        assert self.commit() == Error.OK
        return self.registers.start_screen()


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
        self.device = Device(library, self.registers)
        self.device.set_run(True)
        assert self.device.set_reflections(1) == Error.OK
        library.game_init(self.game, seed)

    def draw(self) -> Error:
        """Draw; return the driver's error."""
        return self.device.call("game_draw", self.game, self.device.handle)

    def step(self, buttons: int) -> set[str]:
        """Run a frame with these buttons, without drawing; return its events."""
        bits = self.software.game_step(self.game, buttons)
        return {name for name, bit in EVENTS.items() if bits & bit}

    def autoplay(self) -> int:
        """Return the buttons that a good player would hold now."""
        return self.software.game_autoplay(self.game)

    def play(self, script: Iterable[int]) -> Iterator[Frame]:
        """Play, draw and show frame after frame; the sticky errors must stay clear."""
        for buttons in script:
            self.registers.written.clear()
            events = self.step(buttons)
            assert self.draw() == Error.OK
            written = list(self.registers.written)
            live = self.device.shown()
            assert self.device.check() == Error.OK
            yield Frame(events, live, written)

    def start(self) -> None:
        """Press fire in attract mode."""
        assert self.step(FIRE) == {"STARTED"}

    def phase(self) -> str:
        """Return the name of the phase in `enum game_phase`."""
        return enumerators(GAME_HEADER, "game_phase")[self.game.phase].removeprefix("GAME_")
