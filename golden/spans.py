# SPDX-License-Identifier: MIT
"""The unit of the span engine, row by row: its runs of columns of one colour, its steps, and its cycles.

Along a row the slope of the rays is linear in the column, D(c) = D0 + c G. So is everything that decides what a ray
sees, after any mirrors (the eye is mirrored instead of the ray, Heckbert and Hanrahan 1984), and the columns that see a
rectangle through a chain of mirrors are an interval. Its ends are columns at which a line changes its sign: one integer
division each. Nothing is rounded, and the work hardly depends on the number of columns. Spans of a row are as old as
Watkins (1970); Underflow Cubed (Tiny Tapeout, 2026) calls its own Ray Interval Tracing.

This model takes the steps of the hardware in its order, in Python's integers, which never overflow. It shares nothing
with the model of the picture, `golden.exact`, with which tests compare it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.scene import UNTURNED, Basis, Light, Scene
from raycaster.screens import Screen

ANSWER = 5
"""Cycles from a line's query to its values."""

Vector = tuple[int, ...]
"""Coordinates or channels, three of them."""


class Line(NamedTuple):
    """A line f(c) = at_0 + c * growth over the columns of a row."""

    at_0: int
    growth: int

    def at(self, column: int) -> int:
        """Return the value at a column."""
        return self.at_0 + column * self.growth


def combined(a: int, x: Line, b: int, y: Line, strict: int = 0) -> Line:
    """Return a x - b y - strict, the form of every line that the hardware evaluates."""
    return Line(a * x.at_0 - b * y.at_0 - strict, a * x.growth - b * y.growth)


def first_change(value: int, growth: int) -> int:
    """Return the columns from one where a line has this value to the first at which its sign differs; there is one."""
    return 1 + (~value if value < 0 else value) // abs(growth)


Rays = tuple[Line, ...]
"""The slope of rays, in one component after the other."""


def folded(rays: Rays, axis: int, back: bool) -> Line:
    """Return a component of a slope, with its sign changed or not."""
    line = rays[axis]
    return Line(-line.at_0, -line.growth) if back else line


class Rect(NamedTuple):
    """A rectangle of the table, with a plane."""

    index: int
    axis: int
    plane: int
    low: Vector
    high: Vector
    quarters: int
    kind: int
    cell: int
    colour: Vector
    colour_2: Vector

    @property
    def is_point(self) -> bool:
        """True if it has no extent."""
        return self.low == self.high


class Chain(NamedTuple):
    """The mirrors that a ray has met, and the columns in which all rays have met them; see `span.records.Chain`."""

    start: int
    stop: int
    eye: Vector
    back: tuple[bool, ...]
    """Components of the slope that have changed their sign."""

    distance: int = 0
    """N of the last mirror, which is met at t = N / e; 0 before the first one."""

    ahead: Line = Line(0, 0)
    """e of the last mirror."""

    met: frozenset[int] = frozenset()
    """Axes of the mirrors met in the last mirror's point."""

    mirror: tuple[int, int] = (0, 0)
    """Axis and plane of the last mirror."""


class Entry(NamedTuple):
    """A rectangle that a chain's rays meet in the columns from start to stop, at t = N / e."""

    rect: Rect
    start: int
    stop: int
    distance: int
    """N, more than 0."""

    ahead: Line
    """e, more than 0 in those columns."""

    def follows(self, other: Entry) -> bool:
        """Return True if an entry on the same axis is seen first."""
        return (other.distance, other.rect.index) < (self.distance, self.rect.index)


def order(first: Entry, second: Entry) -> Line:
    """Return a line that is not negative where the first entry is seen before the second one."""
    later = int(first.rect.index > second.rect.index)
    return combined(second.distance, first.ahead, first.distance, second.ahead, later)


@dataclass
class Cells:
    """The cells of a pattern along one axis, from the present column to the right."""

    edge: tuple[Line, Line]
    """The edge of cell 0, times e, and how much more an edge is for each further cell: a line that is not negative
    where a point is at the edge or beyond."""

    cell: int = 0
    """Number of the present cell."""

    next: int = 0
    """The column in which the next cell begins; the span's end if there is none."""

    rises: bool = False
    """The next cell's number is greater."""

    def line(self, edge: int) -> Line:
        """Return the line of an edge."""
        return combined(1, self.edge[0], edge, self.edge[1])


@dataclass
class Surface:
    """The surface that is seen at a level, from the present column to the right."""

    weight: int
    """The surface's weight in the picture."""

    colours: tuple[Vector, Vector]
    stop: int
    """The column after it."""

    kind: int = 0
    """The pattern, as in `Rectangles`."""

    cells: list[Cells] = field(default_factory=list)
    """The pattern's cells, along u and v as far as it needs them."""

    shadows: list[tuple[int, int]] = field(default_factory=list)
    """Columns in which a rectangle is between the surface and the light."""

    dark: bool = False
    """The light does not reach the present column."""

    next_dark: int = 0
    """The column in which that changes, or might; stop if it does not."""

    @property
    def next(self) -> int:
        """The column in which the colour changes, or might."""
        return min([self.next_dark, *(cells.next for cells in self.cells)])

    def colour(self, shade: int) -> Vector:
        """Return the colour at the present column; shade quarters of it remain in the dark."""
        colour = self.colours[sum(cells.cell for cells in self.cells) % 2]
        return tuple(shade * channel >> 2 for channel in colour) if self.dark else colour


@dataclass
class Row:
    """A row that is drawn."""

    runs: list[tuple[int, Vector]] = field(default_factory=list)
    """The column after each run, and its colour. No run is empty, and neighbours differ in colour."""

    cycles: int = 0
    """Clock cycles from the start, which counts, to the row's end, if each run is taken at once."""

    taken: list[int] = field(default_factory=list)
    """Clock cycles from the start to that in which each run is taken."""

    steps: Counter = field(default_factory=Counter)
    """Numbers of chains, rectangles that were tested, divisions, entries, passes, spans and the like."""


@dataclass(frozen=True)
class SpanModel:
    """The span engine, drawing one table from one place."""

    rectangles: Rectangles
    camera: Sequence[int]
    background: Sequence[int]
    columns: int
    reflections: int
    light: Light | None = None
    patterns: bool = False
    """The design has patterns."""

    lights: bool = False
    """The design has a light: rays pass a register before each set-up, and its divisions take a bit per cycle."""

    @property
    def varied(self) -> bool:
        """True if colours are kept for a cycle before they are mixed."""
        return self.patterns or self.lights

    @cached_property
    def table(self) -> tuple[Rect, ...]:
        """The rectangles that can be seen."""
        return tuple(_rects(self.rectangles))

    def row(self, slope: Sequence[int], step: Sequence[int]) -> Row:
        """Draw a row.

        Args:
            slope: D0, the slope of column 0.
            step: G, its change from column to column.
        """
        drawing = Drawing(self, tuple(Line(int(at_0), int(growth)) for at_0, growth in zip(slope, step, strict=True)))
        return drawing.draw()

    def rows(self, screen: Screen, basis: Basis = UNTURNED) -> Iterator[Row]:
        """Draw all rows of a screen, from the top."""
        for row in range(screen.rows):
            yield self.row(*row_slope(screen, basis, row))

    @classmethod
    def of_scene(cls, scene: Scene, screen: Screen, reflections: int | None = None) -> SpanModel:
        """Return the model for a scene, with its own reflections if none are given."""
        return cls(
            Rectangles.of_scene(scene), scene.camera.position, scene.background, screen.columns,
            scene.reflections if reflections is None else reflections, scene.light,
        )  # fmt: skip


def row_slope(screen: Screen, basis: Basis, row: int) -> tuple[Vector, Vector]:
    """Return the slope of a row's first column, and its change from column to column.

    Args:
        screen: grid of rays.
        basis: forward, right and up of the camera, times 256; without a turn, a slope is not times 256.
        row: 0 for the highest.
    """
    aside, above = -screen.centre_column, screen.horizon_row - row
    if basis == UNTURNED:
        return (screen.view_distance, aside, above), (0, 1, 0)
    along_x, along_y, along_z = (
        screen.view_distance * forward + aside * right + above * up for forward, right, up in zip(*basis, strict=True)
    )
    return (along_x, along_y, along_z), basis[1]


def picture_of(rows: Sequence[Row], columns: int) -> np.ndarray:
    """Return the picture that rows of runs make, uint8 (rows, columns, 3)."""
    picture = np.zeros((len(rows), columns, 3), dtype=np.uint8)
    for place, row in enumerate(rows):
        start = 0
        for end, colour in row.runs:
            picture[place, start:end] = colour
            start = end
    return picture


def _rects(table: Rectangles) -> Iterator[Rect]:
    """Yield the rectangles that can be seen."""
    for index in np.flatnonzero(table.visible).tolist():
        axis, low, high = int(table.axes[index]), tuple(table.low[index].tolist()), tuple(table.high[index].tolist())
        yield Rect(
            index, axis, low[axis], low, high, int(table.mirrors[index]), int(table.kinds[index]),
            int(table.cells[index]), tuple(table.colours[index].tolist()), tuple(table.colours_2[index].tolist()),
        )  # fmt: skip


class Drawing:
    """A row that is being drawn; `now` is the number of the present cycle."""

    def __init__(self, model: SpanModel, slope: Rays):
        self.model, self.slope, self.result, self.now = model, slope, Row(), 0
        bits = (model.columns - 1).bit_length()
        self.division = 2 + (bits if model.lights else (bits + 1) // 2)
        """Cycles of a division."""
        self.shown: list[Surface] = []
        """Surfaces seen at each level, up to the present one."""

    def draw(self) -> Row:
        """Draw the row."""
        self.now += 1
        start = Chain(0, self.model.columns, tuple(int(one) for one in self.model.camera), (False, False, False))
        self.chain(start, 4**self.model.reflections)
        # The last run passes three registers.
        self.result.cycles = self.now + 3
        self.result.taken.append(self.now + 2)
        return self.result

    # -- Chains and their spans

    def chain(self, chain: Chain, weight: int) -> None:
        """Draw the columns of a chain, whose colours have this weight in the picture."""
        self.result.steps["chains"] += 1
        entries = self.set_up(chain)
        winner, column = None, chain.start
        while column < chain.stop:
            stop, heir = self.sweep(entries, chain, column, winner)
            if column < stop:
                self.span(chain, column, stop, winner, weight)
            # The chain behind a mirror ends in the cycle in which this one goes on, or ends too.
            if stop < chain.stop:
                self.now += 1
            column, winner = stop, heir

    def span(self, chain: Chain, column: int, stop: int, winner: Entry | None, weight: int) -> None:
        """Draw a span, in which the winner is seen."""
        self.result.steps["spans"] += 1
        level = len(self.shown)
        quarters = winner.rect.quarters if winner and level < self.model.reflections else 0
        while column < stop:
            self.now += 1
            part, corner = self.corner(chain, column, stop, winner) if winner and quarters else (stop, False)
            self.shown.append(self.paint(chain, column, stop, winner, weight * (4 - quarters) // 4))
            if winner and quarters:
                self.now += 1
                self.chain(self.behind(chain, winner, column, part, corner), weight * quarters // 4)
                # The frame is read, and the winner's rectangle too if there is a second part.
                if part < self.model.columns:
                    self.now += 1 + (part < stop)
            else:
                self.emit(stop)
            self.shown.pop()
            column = part

    def corner(self, chain: Chain, column: int, stop: int, winner: Entry) -> tuple[int, bool]:
        """Return the end of the first columns in which the winner is met in the last mirror's point, or is not."""
        if not chain.distance or winner.rect.axis in chain.met:
            return stop, False
        self.result.steps["corner tests"] += 1
        self.now += ANSWER + 1
        line = combined(winner.distance, chain.ahead, chain.distance, winner.ahead)
        at_left, at_right = line.at(column) == 0, line.at(stop - 1) == 0
        if at_left == at_right:
            return stop, at_left
        return (column + 1, True) if at_left else (stop - 1, False)

    def behind(self, chain: Chain, winner: Entry, start: int, stop: int, corner: bool) -> Chain:
        """Return the chain that the winner reflects in some columns."""
        axis, plane = winner.rect.axis, winner.rect.plane
        eye = tuple(2 * plane - one if axis == place else one for place, one in enumerate(chain.eye))
        back = tuple(one != (axis == place) for place, one in enumerate(chain.back))
        met = (chain.met if corner else frozenset()) | {axis}
        return Chain(start, stop, eye, back, winner.distance, winner.ahead, met, (axis, plane))

    # -- Surfaces

    def paint(self, chain: Chain, column: int, stop: int, winner: Entry | None, weight: int) -> Surface:
        """Return what is seen in a span, and find its first cells and shadows."""
        self.now += 1
        if winner is None:
            colour = tuple(int(channel) for channel in self.model.background)
            return Surface(weight, (colour, colour), stop, next_dark=stop)
        rect = winner.rect
        surface = Surface(weight, (rect.colour, rect.colour_2), stop, rect.kind, next_dark=stop)
        if not weight:
            return surface
        # A checker has cells along u and v, rows only along v, and columns only along u.
        along_u, along_v = OTHER_AXES[rect.axis]
        for u in ((), (along_u, along_v), (along_v,), (along_u,))[rect.kind]:
            aside = folded(self.slope, u, chain.back[u])
            edge = combined(winner.distance, aside, -chain.eye[u], winner.ahead)
            cells = Cells((edge, combined(rect.cell, winner.ahead, 0, winner.ahead)))
            self.now += ANSWER + 3 + self.division
            cells.cell = edge.at(column) // (rect.cell * winner.ahead.at(column))
            self.follow(cells, column, stop)
            surface.cells.append(cells)
        if self.model.light:
            self.shade(surface, chain, column, winner, self.model.light.position)
        return surface

    def follow(self, cells: Cells, column: int, stop: int) -> None:
        """Find the column in which the next cell of a pattern begins."""
        self.result.steps["cells"] += 1
        self.now += ANSWER + 4
        above, below, cells.next = cells.line(cells.cell + 1), cells.line(cells.cell), stop
        cells.rises = above.at(stop - 1) >= 0
        if not cells.rises and below.at(stop - 1) >= 0:
            return
        line = above if cells.rises else below
        cells.next = column
        if (line.at(column) < 0) == cells.rises:
            self.result.steps["divisions"] += 1
            self.now += self.division
            cells.next += first_change(line.at(column), line.growth)

    def shade(self, surface: Surface, chain: Chain, column: int, winner: Entry, light: Vector) -> None:
        """Find the shadows on a surface."""
        axis, plane = winner.rect.axis, winner.rect.plane
        # The rays come from the side of the eye.
        if (light[axis] - plane) * (plane - chain.eye[axis]) >= 0:
            surface.dark = True
            return
        self.result.steps["lit"] += 1
        # The slope from the light to the point, times e, which is linear too.
        rays = tuple(
            combined(winner.distance, folded(self.slope, u, chain.back[u]), light[u] - chain.eye[u], winner.ahead)
            for u in range(3)
        )
        self.now += 5 + ANSWER
        fan = Chain(column, surface.stop, tuple(light), (False, False, False))
        surface.shadows = [(one.start, one.stop) for one in self.set_up(fan, rays, winner.ahead)]
        self.look(surface, column)

    def look(self, surface: Surface, column: int) -> None:
        """Find whether a column is in a shadow, and where that changes, or might."""
        self.now += len(surface.shadows) + 2
        covering = [stop for start, stop in surface.shadows if start <= column < stop]
        surface.dark = bool(covering)
        later = [start for start, _ in surface.shadows if start > column]
        surface.next_dark = max(covering) if covering else min(later, default=surface.stop)

    def emit(self, stop: int) -> None:
        """Mix the colours of all levels, up to a column."""
        while True:
            self.result.steps["parts"] += 1
            self.now += len(self.shown) + 1 + self.model.varied
            end = min([stop, *(surface.next for surface in self.shown)])
            self.run(end)
            if end == stop:
                return
            for surface in self.shown:
                self.step(surface, end)

    def step(self, surface: Surface, column: int) -> None:
        """Go on to a column."""
        for cells in surface.cells:
            while cells.next == column:
                self.now += 1
                cells.cell += 1 if cells.rises else -1
                self.follow(cells, column, surface.stop)
        if surface.next_dark == column:
            self.now += 1
            self.look(surface, column)
        self.now += 1

    def run(self, end: int) -> None:
        """Append a run up to a column, in the colour of all levels.

        The column may be the present one: the cell of a mirror's pattern may end where a span behind it does.
        """
        shade = self.model.light.quarters if self.model.light else 0
        seen = [(surface.weight, surface.colour(shade)) for surface in self.shown]
        mixed = tuple(
            sum(weight * colour[channel] for weight, colour in seen) >> 2 * self.model.reflections
            for channel in range(3)
        )
        runs = self.result.runs
        if end == (runs[-1][0] if runs else 0):
            return
        if runs and runs[-1][1] == mixed:
            runs.pop()
        elif runs:
            self.result.taken.append(self.now + 1)  # nothing can be joined to the run before
        runs.append((end, mixed))

    # -- The entries of a chain

    def set_up(self, chain: Chain, rays: Rays | None = None, ahead: Line | None = None) -> list[Entry]:
        """Return the rectangles that a chain's rays meet, each with its columns.

        Args:
            chain: the chain; or with its rays, those from the light to the points of a surface.
            rays: the slope, if it is not the row's own.
            ahead: with rays, e at the surface; a rectangle at t = n / |slope| is in the way if that is less than 1 / e.
        """
        entries = []
        # The slope's components are asked for, one per cycle; a chain's in the first cycle in which it is there.
        hand = self.now + 3 + ANSWER + self.model.lights + (1 if rays else 0)
        accepted, issued = hand, 0
        for rect in self.model.table:
            lines = self.half_lines(chain, rect, rays, ahead)
            if not lines:
                hand += 1
                continue
            self.result.steps["rectangles"] += 1
            # The line before has been asked.
            accepted = max(hand, issued)
            issued, hand = accepted + len(lines), accepted + 1
            start, stop = self.clip(chain, lines.values())
            if start < stop:
                entries.append(Entry(rect, start, stop, *self.approach(chain, rect, rays)))
        # Each line passes the divider.
        self.now = max(hand, issued + ANSWER + self.division + 2 if issued else 0) + 1
        self.result.steps["entries"] += len(entries)
        return entries

    def approach(self, chain: Chain, rect: Rect, rays: Rays | None = None) -> tuple[int, Line]:
        """Return N and e, with which the rays of a chain meet a rectangle's plane at t = N / e."""
        far = rect.plane - chain.eye[rect.axis]
        return abs(far), folded(rays or self.slope, rect.axis, chain.back[rect.axis] != (far < 0))

    def half_lines(
        self, chain: Chain, rect: Rect, rays: Rays | None = None, surface: Line | None = None
    ) -> dict[int, Line]:
        """Return the lines that are not negative where a chain's rays meet a rectangle, by their numbers.

        There are none if the plane is not ahead at either end of the chain, or if the rectangle is before the last
        mirror. Number 0 is needed for rays from the light, which end at the surface, and otherwise only if the bounds
        do not imply it: the rectangle is a point, or the slope may be 0 in some column. Number 5 is needed unless the
        whole rectangle is beyond the last mirror. See `set_up` for the arguments.
        """
        distance, ahead = self.approach(chain, rect, rays)
        first, last = ahead.at(chain.start) > 0, ahead.at(chain.stop - 1) > 0
        sides = self.sides(chain, rect)
        if not distance or not (first or last) or max(sides) < int(rect.axis == chain.mirror[0]):
            return {}
        lines = {}
        if surface:
            lines[0] = combined(1, ahead, distance, surface, 1)
        elif first != last and (rect.is_point or self.vanishes(chain)):
            lines[0] = combined(1, ahead, 0, ahead, 1)
        for place, u in enumerate(OTHER_AXES[rect.axis]):
            aside = folded(rays or self.slope, u, chain.back[u])
            lines[1 + 2 * place] = combined(distance, aside, rect.low[u] - chain.eye[u], ahead)
            lines[2 + 2 * place] = combined(rect.high[u] - chain.eye[u], ahead, distance, aside)
        if min(sides) < 1:
            lines[5] = combined(distance, chain.ahead, chain.distance, ahead, int(rect.axis in chain.met))
        return lines

    @staticmethod
    def sides(chain: Chain, rect: Rect) -> tuple[int, int]:
        """Return 1, 0 or -1 for both ends of a rectangle along the last mirror's axis: beyond, on, or before it."""
        if not chain.distance:
            return 1, 1
        axis, plane = chain.mirror
        way = 1 if plane > chain.eye[axis] else -1
        low, high = (way * (end - plane) for end in (rect.low[axis], rect.high[axis]))
        return (low > 0) - (low < 0), (high > 0) - (high < 0)

    def vanishes(self, chain: Chain) -> bool:
        """Return True if each component of the slope is 0 in the chain, or changes its sign."""
        ends = [(line.at(chain.start), line.at(chain.stop - 1)) for line in self.slope]
        return all(min(left, right) <= 0 <= max(left, right) for left, right in ends)

    def clip(self, chain: Chain, lines: Iterable[Line]) -> tuple[int, int]:
        """Return the columns in which all lines are not negative."""
        start, stop = chain.start, chain.stop
        ends = [(line.at(start), line.at(stop - 1), line.growth) for line in lines]
        if any(left < 0 and right < 0 for left, right, _ in ends):
            return start, start
        for left, right, growth in ends:
            if (left < 0) != (right < 0):
                border = chain.start + first_change(left, growth)
                self.result.steps["divisions"] += 1
                if left < 0:
                    start = max(start, border)
                else:
                    stop = min(stop, border)
        return start, stop

    # -- The sweep

    def sweep(
        self, entries: Sequence[Entry], chain: Chain, column: int, winner: Entry | None
    ) -> tuple[int, Entry | None]:
        """Return the end of the span that begins at a column, and the entry that is seen next."""
        self.result.steps["passes"] += 1
        self.result.steps["scanned"] += len(entries)
        self.now += 1
        stop, heir = winner.stop if winner else chain.stop, None
        for entry in entries:
            self.now += 1
            found = self.takes(entry, winner, column, stop) if winner else self.begins(entry, column, stop)
            if found is None:
                continue
            self.now += 1
            if found < stop or heir is None or self.precedes(entry, heir, stop):
                stop, heir = found, entry
        self.now += 1
        return stop, heir

    def begins(self, entry: Entry, column: int, stop: int) -> int | None:
        """Return the column at which an entry ends a gap."""
        return entry.start if column <= entry.start <= stop else None

    def takes(self, entry: Entry, winner: Entry, column: int, stop: int) -> int | None:
        """Return the first column up to stop at which an entry is seen instead of the winner."""
        left = max(column, entry.start)
        if entry is winner or left >= entry.stop or left > stop:
            return None
        if left >= winner.stop:
            return stop
        follows = stop if stop == winner.stop and stop < entry.stop else None
        if entry.rect.axis == winner.rect.axis:
            return follows if entry.follows(winner) else left
        self.result.steps["orders"] += 1
        self.now += ANSWER
        line = order(entry, winner)
        right = min(entry.stop - 1, stop if stop < winner.stop else stop - 1)
        if line.at(left) >= 0:
            return left
        if line.at(right) >= 0:
            self.result.steps["divisions"] += 1
            self.now += self.division + 2
            return left + first_change(line.at(left), line.growth)
        return follows

    def precedes(self, entry: Entry, heir: Entry, column: int) -> bool:
        """Return True if an entry is seen before the heir, where both follow."""
        if entry.rect.axis == heir.rect.axis:
            return heir.follows(entry)
        self.result.steps["orders"] += 1
        self.now += ANSWER
        return order(entry, heir).at(column) >= 0
