# SPDX-License-Identifier: MIT
"""Levels: maps of characters, which become scenes.

A map is seen from above. Its lines go along x, the last one first, and its columns along y. A character is a cell: a
block of wall from the floor to the ceiling, or open. Blocks get rectangles only next to open cells. Rectangles in one
plane are merged greedily: each reaches across places of its look, and across those that nobody sees, which are inside
of walls or covered by an earlier rectangle of the plane.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from raycaster.complaints import did_you_mean
from raycaster.configuration import MOST_RECTANGLES, MOST_REFLECTIONS, WORLD_SIZE
from raycaster.errors import UserError, listed
from raycaster.scene import CELLS, PATTERNS, Camera, Light, Rectangle, Scene

MOST_BYTES = 100_000
"""Size in bytes of the largest map that is read."""


class LevelError(UserError):
    """A refused map; the text names the file, the line and the column, and what was expected."""


class Look(NamedTuple):
    """The look of a surface: keys of a `Rectangle`, with the default cell for one without a pattern."""

    colour: tuple[int, int, int]
    mirror: float = 0.0
    pattern: str = PATTERNS[0]
    colour2: tuple[int, int, int] | None = None
    cell: int = 32

    @property
    def keys(self) -> dict[str, Any]:
        """Keys of a rectangle with this look."""
        plain = {"colour": self.colour, "mirror": self.mirror}
        return plain if self.colour2 is None else plain | self._asdict()

    def dimmed(self, share: float) -> Look:
        """Return the look with a share of its brightness."""

        def less(colour: tuple[int, int, int]) -> tuple[int, int, int]:
            red, green, blue = (round(share * channel) for channel in colour)
            return red, green, blue

        return self._replace(colour=less(self.colour), colour2=self.colour2 and less(self.colour2))


@dataclass(frozen=True)
class Cell:
    """The meaning of a character.

    Attributes:
        kind: `wall`, or an open cell: `floor`, `start` or `light`.
        wall: look of a wall's faces.
        floor: look of an open cell's floor.
        ceiling: look of its ceiling; None if the cell is below the sky.
        value: degrees from x towards y in which a start looks, or the shade of a light.
    """

    kind: str
    wall: Look | None = None
    floor: Look | None = None
    ceiling: Look | None = None
    value: float = 0.0

    @property
    def is_open(self) -> bool:
        """True if one may walk there."""
        return self.wall is None


WALL, MIRROR = Cell("wall", Look((176, 144, 104))), Cell("wall", Look((200, 210, 220), 0.75))
FLOOR = Cell("floor", floor=Look((110, 100, 88)), ceiling=Look((216, 210, 196)))
START, LIGHT = replace(FLOOR, kind="start"), replace(FLOOR, kind="light", value=0.5)

KINDS: Mapping[str, Cell] = {"wall": WALL, "mirror": MIRROR, "floor": FLOOR, "start": START, "light": LIGHT}
"""Words that give a character its meaning, with what is not said."""

LEGEND: Mapping[str, Cell] = {
    "#": WALL, "M": MIRROR, ".": FLOOR, " ": FLOOR, "*": LIGHT, "^": START, ">": replace(START, value=90.0),
    "v": replace(START, value=180.0), "<": replace(START, value=-90.0),
}  # fmt: skip
"""Meaning of the characters, unless the head of the map says otherwise."""

USUAL = "."
"""The character whose floor and ceiling a start, a light and a space have."""


class Hidden:
    """A place that nobody sees, so that a rectangle may reach across it."""


HIDDEN = Hidden()

Seen = Look | Hidden | None
"""What is at a place of a plane: a surface, anything, or a hole."""


@dataclass
class Level:
    """A map that has been read; lengths are in world units.

    Attributes:
        title: title of the scene.
        cell: size of a cell.
        height: height of the walls.
        eye: height of the camera.
        pitch: degrees that the camera looks up.
        side: brightness of walls across y, compared with walls across x.
        reflections: as in a scene.
        background: as in a scene.
        cells: cells by x and y.
    """

    title: str
    cell: int = 32
    height: int = 96
    eye: int = 40
    pitch: float = -25.0
    side: float = 0.8
    reflections: int = 1
    background: tuple[int, int, int] = (144, 192, 232)
    cells: list[list[Cell]] = field(default_factory=list)

    def scene(self) -> Scene:
        """Return the scene of the map."""
        [(x, y, yaw)] = self._all("start")
        lights = [
            Light(position=(*self._middle(x, y), self.height * 7 // 8), shade=shade)
            for x, y, shade in self._all("light")
        ]
        camera = Camera(position=(*self._middle(x, y), self.eye), yaw=yaw, pitch=self.pitch)
        return Scene(
            title=self.title, reflections=self.reflections, background=self.background, camera=camera,
            light=lights[0] if lights else None, rect=tuple(self._rectangles()),
        )  # fmt: skip

    def _all(self, kind: str) -> list[tuple[int, int, float]]:
        """Return place and value of the cells of a kind."""
        cells = ((x, y, cell) for x, row in enumerate(self.cells) for y, cell in enumerate(row))
        return [(x, y, cell.value) for x, y, cell in cells if cell.kind == kind]

    def _middle(self, x: int, y: int) -> tuple[int, int]:
        return (2 * x + 1) * self.cell // 2, (2 * y + 1) * self.cell // 2

    def _at(self, x: int, y: int) -> Cell | None:
        """Return a cell; None outside of the map."""
        return self.cells[x][y] if 0 <= x < len(self.cells) and 0 <= y < len(self.cells[x]) else None

    def _rectangles(self) -> Iterator[Rectangle]:
        """Yield floors, ceilings, walls across x, and walls across y."""
        count_x, count_y, numbers = len(self.cells), max(map(len, self.cells)), Counter()

        def rectangle(name: str, look: Look, *corners: tuple[int, int, int]) -> Rectangle:
            name = "mirror" if look.mirror else name
            numbers[name] += 1
            ends = [[min(self.cell * x, WORLD_SIZE - 1), min(self.cell * y, WORLD_SIZE - 1), z] for x, y, z in corners]
            return Rectangle.model_validate({"name": f"{name} {numbers[name]}", "corners": ends, **look.keys})

        for name, z in (("floor", 0), ("ceiling", self.height)):
            seen = {(x, y): self._level(x, y, name) for x in range(count_x) for y in range(count_y)}
            for look, x_0, y_0, x_1, y_1 in areas(seen):
                yield rectangle(name, look, (x_0, y_0, z), (x_1, y_1, z))
        for x in range(1, count_x):
            for look, first, last in runs([self._face((x - 1, y), (x, y)) for y in range(count_y)]):
                yield rectangle("wall", look, (x, first, 0), (x, last, self.height))
        for y in range(1, count_y):
            for look, first, last in runs([self._face((x, y - 1), (x, y)) for x in range(count_x)]):
                shaded = look if look.mirror else look.dimmed(self.side)
                yield rectangle("wall", shaded, (first, y, 0), (last, y, self.height))

    def _level(self, x: int, y: int, name: str) -> Seen:
        """Return what is at a cell's floor or ceiling."""
        cell = self._at(x, y)
        return getattr(cell, name) if cell and cell.is_open else cell and HIDDEN

    def _face(self, *places: tuple[int, int]) -> Seen:
        """Return what is between two neighbouring cells."""
        pair = [self._at(*place) for place in places]
        walls = [cell.wall for cell in pair if cell and cell.wall]
        return walls[0] if len(walls) == 1 and None not in pair else HIDDEN if walls else None


def rarest_first(seen: Collection[Seen]) -> list[Look]:
    """Return the looks that are seen, the rarest first."""
    numbers = Counter(one for one in seen if isinstance(one, Look))
    return sorted(numbers, key=lambda look: (numbers[look], repr(look)))


def runs(seen: Sequence[Seen]) -> Iterator[tuple[Look, int, int]]:
    """Yield rectangles that cover a strip of places: look, first place, and the one after the last."""
    hidden = {place for place, one in enumerate(seen) if one is HIDDEN}
    for look in rarest_first(seen):
        own = [place for place, one in enumerate(seen) if one == look]
        while own:
            first = stop = own[0]
            while stop < len(seen) and (seen[stop] == look or stop in hidden):
                stop += 1
            inside = [place for place in own if place < stop]
            yield look, first, inside[-1] + 1
            own = own[len(inside) :]
        hidden |= {place for place, one in enumerate(seen) if one == look}


Place = tuple[int, int]


def areas(seen: Mapping[Place, Seen]) -> Iterator[tuple[Look, int, int, int, int]]:
    """Yield rectangles that cover a grid of places: look, first row and column, and those after the last."""
    hidden = {place for place, one in seen.items() if one is HIDDEN}
    for look in rarest_first(seen.values()):
        own = {place for place, one in seen.items() if one == look}
        rest, free = set(own), own | hidden
        while rest:
            insides = [rest & {*grown(min(rest), free, axes)} for axes in ((0, 1), (1, 0))]
            inside = max(insides, key=len)
            rows, columns = zip(*inside, strict=True)
            yield look, min(rows), min(columns), max(rows) + 1, max(columns) + 1
            rest -= inside
        hidden |= own


def grown(start: Place, free: Collection[Place], axes: tuple[int, int]) -> Iterator[Place]:
    """Yield the places of a rectangle that grows from one place as far as it can, along one axis and then the other."""
    low, high = list(start), list(start)

    def places(low: Sequence[int], high: Sequence[int]) -> Iterator[Place]:
        return ((row, column) for row in range(low[0], high[0] + 1) for column in range(low[1], high[1] + 1))

    for axis in axes:
        for end, step in ((low, -1), (high, 1)):
            while True:
                edge = [list(low), list(high)]
                edge[0][axis] = edge[1][axis] = end[axis] + step
                if not all(place in free for place in places(*edge)):
                    break
                end[axis] += step
    return places(low, high)


class Word(NamedTuple):
    """A word of a line, with the numbers of its line and its first column, from 1."""

    text: str
    line: int
    column: int


WHOLE: Mapping[str, tuple[int, int]] = {
    "cell": (CELLS[0], CELLS[-1]),
    "height": (2, WORLD_SIZE - 1),
    "eye": (1, WORLD_SIZE - 2),
    "reflections": (0, MOST_REFLECTIONS),
}
"""Settings that are whole numbers, with their bounds."""

NUMBERS: Mapping[str, tuple[int, int]] = {"pitch": (-90, 90), "side": (0, 1)}
"""Settings that are numbers, with their bounds."""

SETTINGS = ("title", *WHOLE, *NUMBERS, "background")


class Reader:
    """Reads a map: the settings and meanings of its head, an empty line, and the cells."""

    def __init__(self, path: Path | str):
        self.path = Path(path)
        self.level = Level(self.path.stem.replace("_", " ").capitalize())
        self.legend = dict(LEGEND)
        self.given: dict[str, Word] = {}

    def read(self) -> Level:
        """Read the map.

        Raises:
            LevelError: it is none.
        """
        lines = [line.rstrip() for line in self._text().splitlines()]
        while lines and not lines[-1]:
            lines.pop()
        above = lines.index("") if "" in lines else 0
        for number, line in enumerate(lines[:above], 1):
            if not line.startswith("//"):
                self._head(line, [Word(one[0], number, one.start() + 1) for one in re.finditer(r"\S+", line)])
        if "eye" not in self.given:
            self.level.eye = max(1, self.level.height * 5 // 12)
        elif self.level.eye >= self.level.height:
            self._refuse(self.given["eye"], f"a number below the height of {self.level.height}")
        first = above + ("" in lines)
        self._map(lines[first:], first + 1)
        return self.level

    def _text(self) -> str:
        try:
            with self.path.open("rb") as file:
                read = file.read(MOST_BYTES + 1)
            if len(read) > MOST_BYTES:
                raise LevelError(f"{self.path}: is larger than {MOST_BYTES:,} bytes, the limit for maps")
            return read.decode("utf-8-sig")
        except OSError as error:
            raise LevelError(f"{self.path}: cannot be read: {error.strerror}") from None
        except UnicodeDecodeError:
            raise LevelError(f"{self.path}: is not UTF-8 text; a map is a text file") from None

    def _refuse(self, word: Word, expected: str, hint: str = "") -> NoReturn:
        """Refuse a word.

        Raises:
            LevelError: always.
        """
        got = word.text[:20] if word.text.strip() and word.text.isprintable() else repr(word.text)[:20]
        self._refuse_place(word.line, word.column, f"expected {expected}, got {got if word.text else 'nothing'}{hint}")

    def _refuse_place(self, line: int, column: int, complaint: str) -> NoReturn:
        raise LevelError(f"{self.path}: line {line}, column {column}: {complaint}")

    def _head(self, line: str, words: list[Word]) -> None:
        """Read a line of the head."""
        if line.startswith(" "):
            words.insert(0, Word(" ", words[0].line, 1))
        first = words.pop(0)
        words.append(Word("", first.line, len(line) + 1))
        value = words[0]
        if len(first.text) == 1:
            self.legend[first.text] = self._meaning(words)
        elif first.text == "title":
            self.level.title = line[words[0].column - 1 :]
        elif first.text in WHOLE:
            setattr(self.level, first.text, int(self._number(words.pop(0), *WHOLE[first.text], whole=True)))
        elif first.text in NUMBERS:
            setattr(self.level, first.text, self._number(words.pop(0), *NUMBERS[first.text]))
        elif first.text == "background":
            self.level.background = self._colour(words.pop(0))
        else:
            expected = f"a character or {listed(SETTINGS)}"
            self._refuse(first, expected, did_you_mean(first.text, SETTINGS))
        if first.text != "title" and words[0].text:
            self._refuse(words[0], "the end of the line")
        self.given[first.text] = value

    def _meaning(self, words: list[Word]) -> Cell:
        """Read the meaning of a character, and take its words."""
        kind = words.pop(0)
        if kind.text not in KINDS:
            self._refuse(kind, listed(KINDS), did_you_mean(kind.text, KINDS))
        cell = self.legend[USUAL] if kind.text == "floor" and self.legend[USUAL].is_open else KINDS[kind.text]
        if cell.wall:
            wall = self._look(words, cell.wall)
            if words[0].text:
                wall = wall._replace(mirror=self._quarter(words.pop(0), 4))
            return replace(cell, wall=wall)
        if kind.text == "start":
            return replace(cell, value=self._number(words.pop(0), -360, 360) if words[0].text else cell.value)
        if kind.text == "light":
            return replace(cell, value=self._quarter(words.pop(0), 3) if words[0].text else cell.value)
        assert cell.floor
        cell = replace(cell, floor=self._look(words, cell.floor))
        if words[0].text == "ceiling":
            words.pop(0)
            if words[0].text == "none":
                words.pop(0)
                return replace(cell, ceiling=None)
            return replace(cell, ceiling=self._look(words, Look(self._colour(words[0]))))
        return cell

    def _look(self, words: list[Word], usual: Look) -> Look:
        """Read a colour and a pattern, if they are there, and take their words."""
        look = usual
        if words[0].text.startswith("#"):
            look = Look(self._colour(words.pop(0)), usual.mirror)
        if words[0].text in PATTERNS[1:]:
            look = look._replace(pattern=words.pop(0).text, colour2=self._colour(words.pop(0)), cell=32)
            if words[0].text.isdecimal():
                sizes = {str(size): size for size in CELLS}
                if words[0].text not in sizes:
                    self._refuse(words[0], listed(sizes))
                look = look._replace(cell=sizes[words.pop(0).text])
        return look

    def _colour(self, word: Word) -> tuple[int, int, int]:
        if not re.fullmatch("#[0-9a-fA-F]{6}", word.text):
            self._refuse(word, 'a colour such as "#c8c8b4"')
        red, green, blue = bytes.fromhex(word.text[1:])
        return red, green, blue

    def _quarter(self, word: Word, most: int) -> float:
        """Return a number of quarters, up to this many."""
        choices = {f"{quarters / 4:g}": quarters / 4 for quarters in range(most + 1)}
        if word.text not in choices:
            self._refuse(word, listed(choices))
        return choices[word.text]

    def _number(self, word: Word, lowest: int, highest: int, *, whole: bool = False) -> float:
        """Return a number within bounds."""
        pattern = r"-?\d{1,4}" if whole else r"-?\d{1,4}(\.\d{1,4})?"
        if not re.fullmatch(pattern, word.text, re.ASCII) or not lowest <= float(word.text) <= highest:
            self._refuse(word, f"a{' whole' * whole} number {lowest}..{highest}")
        return float(word.text)

    def _map(self, lines: Sequence[str], first: int) -> None:
        """Read the cells; the first line has this number."""
        level, most = self.level, WORLD_SIZE // self.level.cell
        for number, line in enumerate(lines[: most + 1], first):
            if number == first + most or len(line) > most:
                column = 1 if number == first + most else most + 1
                self._refuse_place(number, column, f"expected at most {most} lines and columns of {level.cell} units")
            for column, character in enumerate(line, 1):
                word = Word(character, number, column)
                if character not in self.legend:
                    known = listed([*sorted({*self.legend} - {" "}), "a space"])
                    self._refuse(word, known, "" if first > 1 else "; an empty line ends the head")
                kind = self.legend[character].kind
                if kind in ("start", "light") and self.given.setdefault(f"a {kind}", word) is not word:
                    there = self.given[f"a {kind}"]
                    self._refuse(word, f"a single {kind}, which is in line {there.line}, column {there.column}")
        if "a start" not in self.given:
            starts = sorted(character for character, cell in self.legend.items() if cell.kind == "start")
            self._refuse_place(first, 1, f"expected a map with a start, {listed([*starts])}")
        usual = self.legend[USUAL]
        if usual.is_open:
            for character, cell in self.legend.items():
                if cell.kind in ("start", "light") or (character == " " and character not in self.given):
                    self.legend[character] = replace(cell, floor=usual.floor, ceiling=usual.ceiling)
        level.cells = [[self.legend[character] for character in line] for line in reversed(lines)]


def load_level(path: Path | str) -> Scene:
    """Read a map, and return its scene.

    Raises:
        LevelError: it is no map, or has more rectangles than any hardware holds; one line.
    """
    scene = Reader(path).read().scene()
    if len(scene.rect) > MOST_RECTANGLES:
        raise LevelError(
            f"{path}: the map makes {len(scene.rect)} rectangles, but no hardware holds more than {MOST_RECTANGLES}; "
            "take fewer walls, longer ones, or fewer colours"
        )
    return scene
