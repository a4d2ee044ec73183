# SPDX-License-Identifier: MIT
"""The golden model in C++, `golden.cpp`: functions of the compiled program, and the program for this machine."""

from __future__ import annotations

import ctypes
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from raycaster.configuration import Configuration
from raycaster.errors import UserError
from raycaster.options import BUILD
from raycaster.screens import Screen
from raycaster.sim.simulator import made, models
from raycaster.web.wasm import DRIVER_HEADERS, GOLDEN, GOLDEN_FLAGS

WORDS = 1024
BOUNCE = 9
"""Numbers per bounce."""


class Golden(ABC):
    """The program as its callers use it."""

    @abstractmethod
    def call(self, name: str, *arguments: int) -> int:
        """Call an exported function."""

    @abstractmethod
    def read(self, address: int, size: int) -> bytes:
        """Read the program's memory."""

    @abstractmethod
    def write(self, address: int, data: bytes) -> None:
        """Write the program's memory."""

    def load(self, words: Iterable[tuple[int, int]]) -> None:
        """Replace the live words by these, with their word addresses."""
        table = np.zeros(WORDS, dtype="<u4")
        for address, word in words:
            table[address] = word
        self.write(self.call("golden_words"), table.tobytes())

    def draw(self, config: Configuration, screen: Screen | None = None) -> np.ndarray:
        """Draw the picture of a design, optionally on another screen."""
        screen = screen or config.screen_geometry
        self.call(
            "golden_draw", config.facts.code, config.rectangles, config.materials, config.patterns, config.turn,
            config.light, screen.columns, screen.rows, screen.horizon_row, screen.scale, config.fraction_bits,
            config.rounding == "nearest", config.colour_bits,
        )  # fmt: skip
        data = self.read(self.call("golden_picture"), 3 * screen.columns * screen.rows)
        return np.frombuffer(data, dtype=np.uint8).reshape(screen.rows, screen.columns, 3)

    def bounces(self, column: int, row: int) -> np.ndarray:
        """Return the bounces of a pixel's ray, `BOUNCE` numbers each."""
        count = self.call("golden_ray", column, row)
        data = self.read(self.call("golden_bounces"), 8 * BOUNCE * count)
        return np.frombuffer(data, dtype="<i8").reshape(count, BOUNCE)


class NativeGolden(Golden):
    """The program compiled for this machine below `build`, unless it is already compiled.

    Raises:
        UserError: the program cannot be compiled.
    """

    def __init__(self, build: Path = BUILD, *, source: Path = GOLDEN, flags: Sequence[str] = ("-O2",)):
        command = ("g++", *GOLDEN_FLAGS, *flags, "-fvisibility=hidden", "-shared", "-fPIC")
        with made(models(build), "golden-native", [source, *DRIVER_HEADERS], command) as (directory, fresh):
            library = directory / "golden.so"
            if fresh:
                done = subprocess.run([*command, source, "-o", library], capture_output=True, text=True, check=False)
                if done.returncode:
                    raise UserError(f"{source.name}: g++ cannot compile it: {done.stderr.strip()}")
            self._library = ctypes.CDLL(str(library))
        for name in ("words", "picture", "bounces"):
            getattr(self._library, f"golden_{name}").restype = ctypes.c_void_p

    def call(self, name: str, *arguments: int) -> int:
        """Call an exported function."""
        return getattr(self._library, name)(*map(int, arguments))

    def read(self, address: int, size: int) -> bytes:
        """Read the program's memory."""
        return ctypes.string_at(address, size)

    def write(self, address: int, data: bytes) -> None:
        """Write the program's memory."""
        ctypes.memmove(address, data, len(data))
