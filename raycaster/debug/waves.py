# SPDX-License-Identifier: MIT
"""Read waveforms: signals by their hierarchical names, with their values at each rising edge of the clock.

waves = Waves(Path("build/wave/boxes/waves.fst"))
row = "bench.dut.ray_caster_renderer_i.place_row"
samples = waves.sample([row, "bench.dut.avs_s0_write"], start_ns=1000)
for time, value in zip(samples.times_ns, samples.values[row]):
    ...
"""

from __future__ import annotations

import difflib
import re
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pywellen

from raycaster.errors import UserError

CLOCK = "bench.clk"
"""Clock of every bench in this project."""

RANGE = re.compile(r"(.+)\[(\d+):(\d+)\]")
"""A range of a signal's bits: the signal's name, the highest and the lowest bit."""


@dataclass(frozen=True)
class Samples:
    """Signals' values at rising edges of the clock."""

    times_ns: list[float]
    """Times of the edges, in ns since the simulation's start, ascending."""

    values: dict[str, list[int | None]]
    """One value per edge, by signal: the value just before the edge, which registers capture. Unsigned; None if any bit
    is unknown, floating or not yet recorded."""

    def begin_ns(self, cycle: int) -> float:
        """Return the start of the cycle that a sample ends, where a viewer shows the cycle's values."""
        return self.times_ns[max(0, cycle - 1)]


class Waves:
    """A waveform file: FST or VCD, as this project's benches write it.

    A name is the path of instances from the bench down, with dots: `bench.dut.ray_caster_renderer_i.row`. An element of
    a memory has its number after the memory's name, in brackets. A name may end with a range of the signal's bits:
    `bench.dut.rect_mem_i.rects_rect_word[24:23]`, or `[23:23]` for one bit.

    Each method raises a UserError if there is no such signal or clock, or if the signal lacks these bits.
    """

    def __init__(self, path: Path):
        """Open a file; values are read only when needed.

        Raises:
            UserError: the file does not exist, or is not a waveform; a missing clock is reported on its first use.
        """
        if not path.is_file():
            raise UserError(f"{path}: there is no such file")
        try:
            file = pywellen.Waveform(str(path))  # pyright: ignore[reportAttributeAccessIssue] compiled, no stubs
        except RuntimeError as error:
            raise UserError(f"{path}: not a waveform: {error}") from None
        self.path = path
        self._variables = {variable.full_name.replace(".[", "["): variable for variable in file.all_vars()}
        self._changes: dict[str, tuple[list[int], list[int | None]]] = {}
        scale = file.timescale
        self.tick_units = scale.factor
        """Units (s, ms, ns, ps ...) per tick of the file: 1, 10 or 100."""
        self._tick_ns = scale.factor * 10.0 ** (scale.unit.to_exponent() + 9)

    def ticks(self, time_ns: float) -> int:
        """Convert a time to ticks of the file."""
        return round(time_ns / self._tick_ns)

    def width(self, name: str) -> int:
        """Number of bits of a signal."""
        _, high, low = self.bits(name)
        return high - low + 1

    def bits(self, name: str) -> tuple[str, int, int]:
        """Split a name into the signal, and the highest and the lowest bit of the range."""
        found = RANGE.fullmatch(name)
        signal = found[1] if found else name
        width = self._variable(signal).bitwidth
        high, low = (int(found[2]), int(found[3])) if found else (width - 1, 0)
        if not low <= high < width:
            raise UserError(f"{self.path}: {signal} has {width} bits, which do not include {name.removeprefix(signal)}")
        return signal, high, low

    def sample(self, names: Iterable[str], start_ns: float = 0) -> Samples:
        """Sample signals at each rising edge from start_ns on."""
        ticks, levels = self._history(CLOCK)
        # If the clock is high at the start of the file, its edge was earlier.
        rising = [tick for i, tick in enumerate(ticks) if levels[i] == 1 and i and levels[i - 1] == 0]
        edges = rising[bisect_left(rising, start_ns / self._tick_ns - 0.5) :]
        values = {}
        for name in names:
            times, after = self._history(name)
            places = [bisect_left(times, edge) for edge in edges]
            values[name] = [after[place - 1] if place else None for place in places]
        return Samples([edge * self._tick_ns for edge in edges], values)

    def _variable(self, name: str) -> Any:
        if name not in self._variables:
            near = difflib.get_close_matches(name, self._variables)
            hint = f"; similar names: {', '.join(near)}" if near else ""
            raise UserError(f"{self.path}: has no signal {name}{hint}")
        return self._variables[name]

    def _history(self, name: str) -> tuple[list[int], list[int | None]]:
        """Return the ticks at which a signal changed, and its values from then on."""
        if name not in self._changes:
            signal, high, low = self.bits(name)
            changes = list(self._variable(signal).signal)
            times = [time for time, _ in changes]
            self._changes[name] = times, [_bits_of(value, high, low) for _, value in changes]
        return self._changes[name]


def _bits_of(value: int | str, high: int, low: int) -> int | None:
    """Extract bits of a value, which is text if any of its bits is unknown; None if one of these is."""
    if isinstance(value, str):
        text = value[len(value) - 1 - high : len(value) - low]
        return int(text, 2) if text and set(text) <= {"0", "1"} else None
    return value >> low & (1 << high - low + 1) - 1


def signed(value: int | None, bits: int) -> int | None:
    """Interpret a value with this many bits as two's complement."""
    if value is None:
        return None
    return value - (1 << bits) if value >> (bits - 1) & 1 else value
