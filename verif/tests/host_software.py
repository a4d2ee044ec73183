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

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.memory_map import BUTTON_NAMES
from raycaster.sim.register_model import LiveScene, RegisterFile, Request
from raycaster.sw.firmware import SOFTWARE, STRICT

COMPILER = shutil.which("gcc") or shutil.which("cc")
ON_HOST_BUS = ("-fcommon", "-include", Path(__file__).with_name("host_bus.h"))
"""Flags that connect the driver to `attached` registers."""

DRIVER_HEADER = SOFTWARE / "raycaster.h"
CONFIG = configure(engine="exact", screen="tiny", rectangles=12)
"""Design whose registers the software is tested with."""

_HEADERS = re.sub(r"//.*", "", "".join(path.read_text() for path in (DRIVER_HEADER, SOFTWARE / "game" / "game.h")))
SEED = int(re.search(r"GAME_SEED = (\d+)", _HEADERS)[1])
FIRE = 1 << BUTTON_NAMES.index("fire")
CORNER = 0b0101
"""Buttons that move the racket into a corner that the ball never reaches."""


def enumeration(name: str) -> type[IntEnum]:
    """Return an enumeration of the headers; its names lose their first word."""
    body = re.search(rf"enum {name} {{(.*?)}}", _HEADERS, re.S)[1]
    members = re.findall(r"[A-Z]+_(\w+)(?: = (\d+))?", body)
    return IntEnum(name, [(member, int(value or place)) for place, (member, value) in enumerate(members)])


Error, Event, Phase = map(enumeration, ("raycaster_error", "game_event", "game_phase"))

TYPES: dict[str, type | None] = {"bool": ctypes.c_bool, "int": ctypes.c_int, "unsigned": ctypes.c_uint, "void": None}
"""Numbers and the structures of the headers, as ctypes, by their names in C."""

TYPES |= {f"{sign}int{bits}_t": getattr(ctypes, f"c_{sign}int{bits}") for sign in ("", "u") for bits in (8, 16, 32)}


def _type(text: str) -> type | None:
    """Return a type of the headers."""
    *_, name = re.findall(r"\w+", text)
    if "*" in text:
        return ctypes.c_char_p if name == "char" else ctypes.POINTER(_type(name))
    return ctypes.c_int if "enum" in text else TYPES[name]


for _name, _body in re.findall(r"^struct (\w+) {(.*?)^};", _HEADERS, re.M | re.S):
    _fields = [
        (member, _type(kind) * CONFIG.rectangles if many else _type(kind))
        for kind, member, many in re.findall(r"([\w ]+[ *])(\w+)(\[GAME_RECTANGLES\])?;", _body)
    ]
    TYPES[_name] = type(_name, (ctypes.Structure,), {"_fields_": _fields})

RayCaster, Game = TYPES["raycaster"], TYPES["game"]
_Read = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_uint32)
_Write = ctypes.CFUNCTYPE(None, ctypes.c_uint32, ctypes.c_uint32)


def members(structure: ctypes.Structure) -> tuple:
    """Convert a structure, with those in it, to tuples."""
    values = (getattr(structure, name) for name, _ in structure._fields_)
    return tuple(members(value) if isinstance(value, ctypes.Structure) else value for value in values)


def compile_library(directory: Path, *sources: str | Path, flags: Sequence[str | Path] = ON_HOST_BUS) -> ctypes.CDLL:
    """Compile sources from sw/, or from elsewhere by absolute path, and load them with the types in the prototypes."""
    library = directory / "library.so"
    command = [COMPILER, *STRICT, "-O1", "-shared", "-fPIC", f"-I{SOFTWARE}", "-o", library, *flags]
    subprocess.run([*command, *(SOFTWARE / source for source in sources)], check=True)
    loaded = ctypes.CDLL(library)
    for kind, name, arguments in re.findall(r"^(\w[\w ]+[ *])(\w+)\(([^)]*)\);", _HEADERS, re.M):
        if function := getattr(loaded, name, None):
            function.argtypes = [_type(re.sub(r"\w+$", "", one)) for one in arguments.split(",")]
            function.restype = Error if "enum raycaster_error" in kind else _type(kind)
    return loaded


class Registers:
    """Registers of a ray tracer, without the rest; StartScreen comes on demand.

    Attributes:
        file: the model.
        written: byte offsets and words of all writes, in order.
        polls_to_frame: reads of the pending interrupt, or of an unfinished commit, until the next StartScreen, or 0.
    """

    def __init__(self, config: Configuration, **said: dict[str, int]):
        """Make the registers of a design; some read-only registers say something else than the design's facts."""
        self.file = RegisterFile(config)
        self.written: list[tuple[int, int]] = []
        self.polls_to_frame = 0
        self.file.clock(True, None)
        words, known = self.file.agent._constants, self.file.agent.registers
        for name, fields in said.items():
            words[name] = known[name].pack(**known[name].unpack(words[name]) | fields)

    def read(self, offset: int) -> int:
        """Read the word at an offset in bytes."""
        agent = self.file.agent
        name = agent.addresses.get(offset // 4)
        if self.polls_to_frame and (name == "irq_pending" or (name == "control" and agent.commit)):
            self.polls_to_frame -= 1
            if not self.polls_to_frame:
                self.start_screen()
        self._request(offset)
        return agent.answer[1]

    def write(self, offset: int, word: int) -> None:
        """Write a word at an offset in bytes."""
        self.written.append((offset, word))
        self._request(offset, word)

    def _request(self, offset: int, word: int | None = None) -> None:
        assert offset % 4 == 0
        # Otherwise StartScreen would also come by itself.
        self.file.clocks = 0
        while not self.file.clock(False, Request(offset // 4, word)):
            pass
        # One clock to answer or to write, and one for a commit's copy.
        for _ in range(2):
            self.file.clock(False, None)

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
        return {event.name for event in Event if bits & event}

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
