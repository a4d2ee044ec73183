# SPDX-License-Identifier: MIT
"""The golden model in C++, `golden.cpp`: functions of the compiled program, and the program for this machine."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

from raycaster.configuration import Configuration
from raycaster.errors import UserError
from raycaster.screens import Screen
from raycaster.sim.simulator import made, models
from raycaster.web.wasm import DRIVER_HEADERS, GOLDEN_FLAGS

WORDS = 1024


class Golden:
    """The compiled program as its callers use it.

    Args:
        call: calls an exported function, given its name and arguments.
        read: reads the program's memory, given an address and a size.
        write: writes the program's memory, given an address and bytes.
    """

    def __init__(
        self, call: Callable[..., int], read: Callable[[int, int], bytes], write: Callable[[int, bytes], object]
    ):
        self.call, self.read, self.write = call, read, write

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


class NativeGolden(Golden):
    """The program compiled for this machine below `build`, unless it is already compiled.

    Raises:
        UserError: the program cannot be compiled.
    """

    def __init__(self, build: Path, *, source: Path, flags: Sequence[str]):
        command = ("g++", *GOLDEN_FLAGS, *flags, "-fvisibility=hidden", "-shared", "-fPIC")
        with made(models(build), "golden-native", [source, *DRIVER_HEADERS], command) as (directory, fresh):
            path = directory / "golden.so"
            if fresh:
                done = subprocess.run([*command, source, "-o", path], capture_output=True, text=True, check=False)
                if done.returncode:
                    raise UserError(f"{source.name}: g++ cannot compile it: {done.stderr.strip()}")
            library = ctypes.CDLL(str(path))
        for name in ("words", "picture"):
            getattr(library, f"golden_{name}").restype = ctypes.c_void_p
        super().__init__(
            lambda name, *arguments: getattr(library, name)(*map(int, arguments)),
            ctypes.string_at,
            lambda address, data: ctypes.memmove(address, data, len(data)),
        )
