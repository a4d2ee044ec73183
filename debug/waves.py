# SPDX-License-Identifier: MIT
"""Reads waveforms: signals by their hierarchical names, with their values at each rising edge of the clock.

waves = Waves(Path("build/sim/boxes/waves.fst"))
state = waves.find("bench.dut.*.ray_sequencer_i.state")
samples = waves.sample([state, "bench.dut.progress_start_screen"], start_ns=1000, end_ns=2000)
for time, value in zip(samples.times_ns, samples.values[state]):
    ...
"""

from __future__ import annotations

import difflib
import math
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import pywellen

from raycaster.errors import UserError

CLOCK = "bench.clk"
"""The clock of every bench here."""

SUGGESTIONS = 3

RANGE = re.compile(r"(.+)\[(\d+):(\d+)\]")
"""Bits of a signal: its name, the highest and the lowest."""


@dataclass(frozen=True)
class Samples:
    """Signals' values at rising edges of the clock."""

    times_ns: list[float]
    """When the edges were, in ns since the simulation's start, ascending."""

    values: dict[str, list[int | None]]
    """By signal, one value an edge: what stood just before it, which is what registers took at it. Unsigned; None where
    any bit is unknown, floating or not yet written down."""


class Waves:
    """A waveform file: FST or VCD, as this project's benches write it.

    A name is the path of instances from the bench down, with dots: `bench.dut.ray_caster_renderer_i.row`. An element of
    a memory has its number after the memory's name, in brackets. Wherever values or widths are
    asked for, a name may mean bits of a signal: `bench.dut.rect_mem_i.rects_rect_word[24:23]`, or one, as `[23:23]`.
    """

    def __init__(self, path: Path, clock: str = CLOCK):
        """Open a file; values are only read where they are asked for.

        Args:
            path: of the file.
            clock: the signal whose rising edges `edges` and `sample` mean.

        Raises:
            UserError: there is no such file, or it is none of these; or it has no such clock, when that is asked for.
        """
        if not path.is_file():
            raise UserError(f"{path}: there is no such file")
        try:
            self._file = pywellen.Waveform(str(path))  # pyright: ignore[reportAttributeAccessIssue] compiled, no stubs
        except RuntimeError as error:
            raise UserError(f"{path}: not a waveform: {error}") from None
        self.path = path
        self._clock = clock
        self._variables = {
            variable.full_name.replace(".[", "["): variable
            for variable in self._file.all_vars()
            if variable.bitwidth is not None
        }
        self._changes: dict[str, tuple[list[int], list[int | None]]] = {}
        scale = self._file.timescale
        self.tick_units = scale.factor
        """Of its unit (s, ms, ns, ps ...), how many a tick of the file has: 1, 10 or 100."""
        self._tick_ns = scale.factor * 10.0 ** (scale.unit.to_exponent() + 9)

    @property
    def names(self) -> tuple[str, ...]:
        """All signals of bits."""
        return tuple(self._variables)

    def matching(self, pattern: str) -> list[str]:
        """The signals whose whole names match a pattern, in which `*` stands for anything, dots included.

        Brackets stand for themselves.
        """
        escaped = pattern.replace("[", "[[]")
        return [name for name in self._variables if fnmatchcase(name, escaped)]

    def find(self, pattern: str) -> str:
        """The one signal whose name matches; see `matching`.

        Raises:
            UserError: none does, or several do.
        """
        found = self.matching(pattern)
        if len(found) > 1:
            raise UserError(f"{self.path}: {pattern} stands for {len(found)} signals: {found[0]}, {found[1]} ...")
        if not found:
            raise self._missing(pattern)
        return found[0]

    def ticks(self, time_ns: float) -> int:
        """A time as the file counts it."""
        return round(time_ns / self._tick_ns)

    def width(self, name: str) -> int:
        """Bits of a signal.

        Raises:
            UserError: there is no such signal, or it has not these bits.
        """
        _, high, low = self.bits(name)
        return high - low + 1

    def bits(self, name: str) -> tuple[str, int, int]:
        """The signal that a name means, and the highest and the lowest of its bits that it means.

        Raises:
            UserError: there is no such signal, or it has not these bits.
        """
        found = RANGE.fullmatch(name)
        signal = found[1] if found else name
        width = self._variable(signal).bitwidth
        high, low = (int(found[2]), int(found[3])) if found else (width - 1, 0)
        if not low <= high < width:
            raise UserError(f"{self.path}: {signal} has {width} bits, not {name.removeprefix(signal)}")
        return signal, high, low

    def span_ns(self) -> tuple[float, float]:
        """When the clock's first and last changes were, in ns.

        Raises:
            UserError: there is no such clock, or it never changes.
        """
        times, _ = self._history(self._clock)
        if not times:
            raise UserError(f"{self.path}: {self._clock} never changes")
        return times[0] * self._tick_ns, times[-1] * self._tick_ns

    def value(self, name: str, time_ns: float) -> int | None:
        """A signal's value at a time, with what changed in that very moment; see `Samples.values`.

        Raises:
            UserError: there is no such signal.
        """
        times, values = self._history(name)
        place = bisect_right(times, self.ticks(time_ns))
        return values[place - 1] if place else None

    def changes(self, name: str) -> list[tuple[float, int | None]]:
        """When a signal changed, in ns, and what to; the first is its value when the file begins.

        Raises:
            UserError: there is no such signal.
        """
        return [(time * self._tick_ns, value) for time, value in zip(*self._history(name), strict=True)]

    def edges(self, start_ns: float = 0, end_ns: float = math.inf) -> list[float]:
        """The clock's rising edges from start_ns, and before end_ns.

        Raises:
            UserError: there is no such clock.
        """
        return [time * self._tick_ns for time in self._edge_ticks(start_ns, end_ns)]

    def sample(self, names: Iterable[str], start_ns: float = 0, end_ns: float = math.inf) -> Samples:
        """Signals at each rising edge from start_ns, and before end_ns.

        Raises:
            UserError: there is no such clock or signal.
        """
        edges = self._edge_ticks(start_ns, end_ns)
        values = {name: _before(edges, *self._history(name)) for name in names}
        return Samples([edge * self._tick_ns for edge in edges], values)

    def _edge_ticks(self, start_ns: float, end_ns: float) -> list[int]:
        times, values = self._history(self._clock)
        # Where the file begins with a high clock, its edge was earlier.
        rising = [time for i, time in enumerate(times) if values[i] == 1 and i and values[i - 1] == 0]
        first = bisect_left(rising, start_ns / self._tick_ns - 0.5)
        return rising[first : bisect_left(rising, end_ns / self._tick_ns - 0.5)]

    def _variable(self, name: str) -> Any:
        if name not in self._variables:
            raise self._missing(name)
        return self._variables[name]

    def _missing(self, name: str) -> UserError:
        near = difflib.get_close_matches(name, self._variables, SUGGESTIONS)
        hint = f"; there are {', '.join(near)}" if near else ""
        return UserError(f"{self.path}: has no signal {name}{hint}")

    def _history(self, name: str) -> tuple[list[int], list[int | None]]:
        """The ticks at which a signal changed, and its values since."""
        if name not in self._changes:
            signal, high, low = self.bits(name)
            changes = list(self._variable(signal).signal)
            times = [time for time, _ in changes]
            self._changes[name] = times, [_bits_of(value, high, low) for _, value in changes]
        return self._changes[name]


def _bits_of(value: int | str | float | None, high: int, low: int) -> int | None:
    """Bits of a value, which is text where any of its bits is unknown; None where one of these is."""
    if isinstance(value, str):
        text = value[len(value) - 1 - high : len(value) - low]
        return int(text, 2) if text and set(text) <= {"0", "1"} else None
    return value >> low & (1 << high - low + 1) - 1 if isinstance(value, int) else None


def _before(edges: Sequence[int], times: Sequence[int], values: Sequence[int | None]) -> list[int | None]:
    """The value just before each edge."""
    sampled, place = [], 0
    for edge in edges:
        while place < len(times) and times[place] < edge:
            place += 1
        sampled.append(values[place - 1] if place else None)
    return sampled


def signed(value: int | None, bits: int) -> int | None:
    """What a value of so many bits is in two's complement."""
    if value is None:
        return None
    return value - (1 << bits) if value >> (bits - 1) & 1 else value
