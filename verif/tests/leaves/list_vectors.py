# SPDX-License-Identifier: MIT
"""Models of the blocks between the span units and the monitor, cycle by cycle, and pictures made of runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from vectors import named

from raycaster.screens import Screen, Span

Run = tuple[int, int]
"""The column after a run's last, and its pixel."""

PIXEL_BITS = 6
BANK = 2048
"""Runs of a bank of a memory."""


def memory_cycles(places: int, bank: int = BANK) -> int:
    """Return the cycles from a place of a memory to its run: two, one for each fourfold of banks, one for feeds."""
    stages = next(stages for stages in range(9) if bank * 4**stages >= places)
    return 2 + stages + (stages > 1)


def slots_of(latency: int) -> int:
    """Return the runs that a `read_ahead` holds or fetches: two and one for each cycle of its memory, or a few more."""
    return 4 if latency == 2 else 8


def any_row(random: np.random.Generator, columns: int) -> list[Run]:
    """Return the runs of a row, often one, or one for each column."""
    return row_of(random, columns, int(random.choice([1, columns, random.integers(1, columns + 1)])))


def row_of(random: np.random.Generator, columns: int, count: int) -> list[Run]:
    """Return a row of this many runs."""
    ends = sorted([*random.choice(np.arange(1, columns), size=count - 1, replace=False).tolist(), columns])
    return [(end, int(random.integers(1 << PIXEL_BITS))) for end in ends]


def pixels_of(row: Sequence[Run]) -> list[int]:
    """Return the pixels of a row."""
    pixels: list[int] = []
    for end, pixel in row:
        pixels += [pixel] * (end - len(pixels))
    return pixels


def entry(prefix: str, run: Run) -> dict[str, int]:
    """Return a run as a `ListEntry` at a port."""
    return named(prefix, {"end": run[0], "pixel": run[1]})


def packed(run: Run) -> int:
    """Return a run as the word of a `ListEntry`."""
    return run[0] << PIXEL_BITS | run[1]


def list_screen(columns: int, rows: int, doubling: int, clocks: int) -> Screen:
    """Return a screen with short blanking."""
    horizontal = Span(columns * doubling, 2, 5, 7, active_high=True)
    vertical = Span(rows * doubling, 1, 1, doubling + 1, active_high=True)
    return Screen(columns, rows, 0, doubling, horizontal, vertical, clocks_per_pixel=clocks)


@dataclass
class Beam:
    """The strobes of `Scan` for a player of `pixels` pixels per clock, and the columns that it must show.

    With one clock per pixel, columns are announced a clock before their first pixel.
    """

    screen: Screen
    pixels: int = 1
    cycle: int = 0

    def __post_init__(self) -> None:
        one = self.screen.horizontal
        self.visible, self.blank = one.visible // self.pixels, one.blank
        self.lead = int(self.screen.clocks_per_pixel == 1)
        self.period = (self.visible + self.blank) * self.screen.vertical.total * self.screen.clocks_per_pixel
        """Cycles of a frame."""

    def scan(self) -> dict[str, int]:
        """Return the signals of this cycle."""
        beat, clock = divmod(self.cycle, self.screen.clocks_per_pixel)
        line, x = divmod(beat, self.visible + self.blank)
        y = line % self.screen.vertical.total - self.screen.vertical.blank
        doubling, last_clock = self.screen.doubling, clock == self.screen.clocks_per_pixel - 1
        ahead = x - self.blank + self.lead
        inside, first = 0 <= ahead < self.visible, x == 0 and clock == 0
        strobes = {"start_screen": first and y == -doubling, "start_row": first and y >= 0 and y % doubling == 0}
        strobes |= {"visible_line": inside, "next_column": inside and last_clock and ahead % doubling == doubling - 1}
        self.column = ahead // doubling * self.pixels
        self.place = (y // doubling, self.column) if inside and y >= 0 else None
        return {name: int(value) for name, value in strobes.items()}

    def clock(self, reset: bool) -> None:
        """End the cycle."""
        self.cycle = 0 if reset else self.cycle + 1


@dataclass
class Queue:
    """`run_queue`, cycle by cycle: a run is fetched a cycle after it came at the earliest.

    It is offered in the cycle after it has come from its memory.
    """

    columns: int
    places: int
    bank: int = BANK
    waiting: list[Run] = field(default_factory=list)
    ahead: list[tuple[int, Run]] = field(default_factory=list)

    @property
    def ready(self) -> bool:
        return len(self.waiting) < self.places

    @property
    def room(self) -> bool:
        return len(self.waiting) <= self.places - self.columns

    @property
    def head(self) -> Run | None:
        return self.ahead[0][1] if self.ahead and self.ahead[0][0] > self.latency else None

    @property
    def latency(self) -> int:
        return memory_cycles(self.places, self.bank)

    def clock(self, run: Run | None, take: bool, reset: bool) -> None:
        """End a cycle in which a run was offered to the queue, or its head was taken."""
        fetches, accepts = bool(self.waiting) and len(self.ahead) < slots_of(self.latency), self.ready
        self.ahead = [(age + 1, one) for age, one in self.ahead[take:]]
        if fetches:
            self.ahead.append((1, self.waiting.pop(0)))
        if run is not None and accepts:
            self.waiting.append(run)
        if reset:
            self.waiting, self.ahead = [], []


@dataclass
class Dealer:
    """`row_dealer`, cycle by cycle."""

    rows: int
    units: int
    row: int = 0
    first_row: bool = False
    settles: bool = False
    dealing: bool = False
    busy: set[int] = field(default_factory=set)
    started: tuple[int, int] | None = None
    """The unit that starts in this cycle, and its row."""

    def deal(self, room: Sequence[bool], done: set[int]) -> int | None:
        """Return the unit that is dealt the row `row` in this cycle."""
        unit = self.row % self.units
        free = unit not in self.busy or unit in done
        return unit if self.dealing and self.row < self.rows and room[unit] and free else None

    def clock(self, new_frame: bool, dealt: int | None, done: set[int], reset: bool) -> None:
        """End the cycle."""
        self.busy -= done
        self.started = None
        if dealt is not None:
            self.busy.add(dealt)
            self.started = dealt, self.row
            self.row += 1
        if self.settles:
            self.row, self.dealing = 0, True
        self.settles, self.first_row = self.first_row, new_frame
        if reset:
            self.settles = self.first_row = self.dealing = False
            self.busy, self.started = set(), None


@dataclass
class Collector:
    """`row_collector`, cycle by cycle: a list of up to `entries` runs, and the number of rows that it lacks."""

    columns: int
    rows: int
    units: int
    entries: int
    rows_left: int = 0
    taken: list[Run] = field(default_factory=list)
    written: tuple[int, Run, bool] | None = None
    """Entry that is written in this cycle: its place, its run, and True if it is the frame's last."""

    @property
    def turn(self) -> int:
        return (self.rows - self.rows_left) % self.units

    def take(self, head: Run | None) -> bool:
        return head is not None and self.rows_left > 0 and len(self.taken) < self.entries

    def full(self, head: Run | None) -> bool:
        return head is not None and self.rows_left > 0 and len(self.taken) == self.entries

    def clock(self, new_frame: bool, head: Run | None, reset: bool) -> None:
        """End the cycle."""
        self.written = None
        if self.take(head) and not reset:
            assert head is not None
            ends = head[0] == self.columns
            self.written = len(self.taken), head, ends and self.rows_left == 1
            self.taken.append(head)
            self.rows_left -= ends
        if new_frame:
            self.rows_left, self.taken = self.rows, []
        if reset:
            self.rows_left = 0


@dataclass
class Unit:
    """A unit, which draws its rows at any pace."""

    random: np.random.Generator
    pause: float = 0.0
    runs: list[Run] = field(default_factory=list)
    offers: bool = False
    done: bool = False

    def clock(self, taken: bool, row: Sequence[Run] | None, reset: bool) -> None:
        """End a cycle in which its run was taken, or in which it was started on a row."""
        self.done = False
        if taken:
            self.runs.pop(0)
            self.done = not self.runs
        if row is not None:
            self.runs = list(row)
        waits = self.offers and not taken
        self.offers = bool(self.runs) and (waits or self.random.random() >= self.pause)
        if reset:
            self.runs, self.offers, self.done = [], False, False


def any_frame(random: np.random.Generator, columns: int, rows: int, entries: int) -> list[list[Run]]:
    """Return the rows of a picture, which has often as many runs as a list has entries, one more or far more."""
    if random.random() < 0.3:
        return [any_row(random, columns) for _ in range(rows)]
    if random.random() < 0.1:
        return [row_of(random, columns, columns) for _ in range(rows)]  # units still draw when the list is full
    counts = [1] * rows
    longer = range(rows - int(random.random() < 0.3))  # the last row may have a single run
    for _ in range(int(random.choice([entries, entries, entries + 1])) - rows):
        counts[int(random.choice([row for row in longer if counts[row] < columns]))] += 1
    return [row_of(random, columns, count) for count in counts]


def side_by_side(words: Sequence[int], bits: int) -> int:
    """Return words side by side, the first in the lowest bits."""
    return sum(word << number * bits for number, word in enumerate(words))
