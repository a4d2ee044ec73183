# SPDX-License-Identifier: MIT
"""The example row of the page about spans: its tables from the model, and the page's pictures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from raycaster.design.decide import configure
from raycaster.golden.spans import Chain, Drawing, Entry, Line, SpanModel, row_slope
from raycaster.report.plots import BLUE, GREY, VERMILION, new_figure, styled, ticks
from raycaster.rtl.engines import EXACT, SPAN
from raycaster.runs.outcomes import table
from raycaster.scene import Camera, Rectangle, Scene, load_scene, packaged_scenes
from raycaster.screens import LIST_SCREENS, Screen

SCREEN = replace(LIST_SCREENS["tiny", 48], distance=20)
ROW = 44
SCENE = Scene(
    title="A floor, a wall and a mirror",
    camera=Camera(position=(60, 256, 120)),
    rect=(
        Rectangle(name="floor", corners=((0, 0, 20), (511, 511, 20)), colour=(200, 200, 180), mirror=0),
        Rectangle(name="wall", corners=((380, 200, 0), (380, 300, 300)), colour=(80, 160, 255), mirror=0),
        Rectangle(name="mirror", corners=((200, 400, 0), (500, 400, 200)), colour=(255, 96, 48)),
    ),
    reflections=1,
)
"""Small enough to follow by hand. In column c of the row, rays have the slope D = (20, c - 32, -6)."""

SEEN_IN_THE_MIRROR = 48, 52
"""First and last column that see the wall in the mirror."""

MEASURED = ("matte", "mirror_room", "facing_mirrors")
"""Scenes with 0, 1 and 2 reflections, for the plot of cycles."""


SIZES = (320, 640, 1280, 1920, 3840)
"""Columns of the measured pictures."""

COUNTS = (4, 8, 16, 32, 64, 128)
"""Rectangles of the measured halls."""

PILLARS = 31
GREY_WALL = (180, 170, 160)
CLOCKS = 25_000_000 / 60 / 240
"""Clock cycles that a row has."""


class ExampleRow(Drawing):
    """A row that is drawn, with the entries of each chain."""

    def __init__(self, model: SpanModel):
        lines = zip(*row_slope(SCREEN, SCENE.camera.basis, ROW), strict=True)
        super().__init__(model, tuple(Line(*line) for line in lines))
        self.chains: list[tuple[Chain, list[Entry]]] = []
        self.draw()

    def set_up(self, chain: Chain, rays: tuple[Line, ...] | None = None, ahead: Line | None = None) -> list[Entry]:
        """Remember the entries, too."""
        entries = super().set_up(chain, rays, ahead)
        self.chains.append((chain, entries))
        return entries


def example_row() -> ExampleRow:
    """Return the example row."""
    return ExampleRow(SpanModel.of_scene(SCENE, SCREEN))


def name_of(entry: Entry) -> str:
    """Return the name of an entry's rectangle."""
    return str(SCENE.rect[entry.rect.index].name)


def rectangles() -> str:
    """Table of the rectangles of the example."""
    rows = []
    for number, rect in enumerate(SCENE.rect):
        low, high = (tuple(map(pick, *rect.corners)) for pick in (min, max))
        where = [str(a) if a == b else f"{a} to {b}" for a, b in zip(low, high, strict=True)]
        rows.append([number, str(rect.name), *where, f"`{_hex(rect.colour)}`", "a half" if rect.mirror else "no"])
    return table(["number", "rectangle", "x", "y", "z", "colour", "mirror"], rows)


def entries() -> str:
    """Table of the entries of the example row."""
    rows = []
    for chain, found in example_row().chains:
        where = f"eye {chain.eye}, columns {chain.start} to {chain.stop - 1}"
        for entry in found:
            at_0, growth = entry.ahead
            ahead = f"c - {-at_0}" if growth else str(at_0)
            rows.append([where, name_of(entry), entry.distance, ahead, f"{entry.start} to {entry.stop - 1}"])
    return table(["chain", "rectangle", "N", "e", "columns"], rows)


def runs() -> str:
    """The runs of the example row, in words."""
    start, words = 0, []
    for end, colour in example_row().result.runs:
        words.append(f"{start} to {end - 1} `{_hex(colour)}`")
        start = end
    return ", ".join(words)


def _hex(colour: tuple[int, ...]) -> str:
    return "#" + "".join(f"{channel:02x}" for channel in colour)


def _shares(colour: tuple[int, ...]) -> tuple[float, ...]:
    return tuple(channel / 255 for channel in colour)


@styled
def row_picture() -> Figure:
    """Draw the example row: its entries as bars, in each chain, above the runs."""
    row = example_row()
    figure, axes = new_figure(2.6)
    ax: Axes = axes[0, 0]
    place, names = 0, []
    for chain, found in row.chains:
        for entry in found:
            colour = _shares(entry.rect.colour)
            ax.barh(place, entry.stop - entry.start, left=entry.start, color=colour, edgecolor="black", linewidth=0.6)
            names.append(f"{name_of(entry)}{' in the mirror' if chain.distance else ''}")
            place += 1
    start = 0
    for end, colour in row.result.runs:
        ax.barh(place + 0.3, end - start, left=start, color=_shares(colour), edgecolor="black", linewidth=0.6)
        start = end
    ax.set_yticks([*range(place), place + 0.3], [*names, "runs"])
    ax.set_xlim(0, SCREEN.columns)
    ax.set_xlabel(f"column of row {ROW}")
    ax.invert_yaxis()
    return figure


@styled
def fold_picture() -> Figure:
    """Draw the example from above: a ray that the mirror reflects, and the straight one from the mirrored eye."""
    x, y, _ = SCENE.camera.position
    figure, axes = new_figure(3.4)
    ax: Axes = axes[0, 0]
    for rect, colour in zip(SCENE.rect[1:], (BLUE, VERMILION), strict=True):
        (x_0, y_0, _), (x_1, y_1, _) = rect.corners
        ax.plot([x_0, x_1], [y_0, y_1], color=colour, linewidth=3)
        beside = (6, -10) if y_0 == y_1 else (-30, 4)
        ax.annotate(str(rect.name), ((x_0 + x_1) / 2, (y_0 + y_1) / 2), xytext=beside, textcoords="offset points")
    plane = SCENE.rect[2].corners[0][1]
    beyond = SCENE.rect[1].corners[0][0]
    for column in SEEN_IN_THE_MIRROR:
        slope = column - SCREEN.centre_column
        met, hit = (plane - y) / slope, (beyond - x) / SCREEN.view_distance
        at = [x + SCREEN.view_distance * t for t in (0, met, hit)]
        ax.plot(at, [y, plane, 2 * plane - y - slope * hit], color="black", linewidth=1)
        ax.plot(at[:2], [2 * plane - y, plane], color=GREY, linewidth=1, linestyle="--")
        end = at[2], 2 * plane - y - slope * hit
        ax.annotate(f"column {column}", end, xytext=(8, -3), textcoords="offset points")
    for place, text in ((y, "eye"), (2 * plane - y, "mirrored eye")):
        ax.plot([x], [place], "o", color="black", markersize=5)
        ax.annotate(text, (x, place), xytext=(8, -3), textcoords="offset points")
    ax.set_xlabel("x")
    ax.set_ylabel("y")
    ax.set_aspect("equal")
    return figure


def finer(columns: int) -> Screen:
    """Return the view of 180 rows with this many columns, a multiple of 320."""
    base, scale = LIST_SCREENS["vga", 180], columns // 320
    return replace(
        base, columns=columns, rows=base.rows * scale, horizon_row=base.horizon_row * scale, doubling=1, scale=scale
    )


def mean_cycles(scene: Scene, columns: int, some: int = 24) -> float:
    """Return the mean cycles of a scene's rows, of as many as this, evenly spread."""
    screen = finer(columns)
    model = SpanModel.of_scene(scene, screen)
    chosen = [screen.rows * (2 * place + 1) // (2 * some) for place in range(some)]
    return sum(model.row(*row_slope(screen, scene.camera.basis, row)).cycles for row in chosen) / some


def measured() -> Iterator[tuple[str, int, list[tuple[int, float]]]]:
    """Yield each measured scene, its reflections, and its mean cycles per row by columns."""
    for name in MEASURED:
        scene = load_scene(packaged_scenes()[name])
        yield name, scene.reflections, [(columns, mean_cycles(scene, columns)) for columns in SIZES]


def pillars(count: int, reflections: int) -> Scene:
    """Return a hall with this many rectangles: its six sides, and those of pillars, of which every third mirrors."""
    low, high = (0, 0, 0), (511, 511, 160)
    room = [(low, (511, 511, 0)), ((0, 0, 160), high), *sides(low, high)]
    rects = [Rectangle(corners=corners, colour=GREY_WALL, mirror=0) for corners in room]
    for number in range(PILLARS):
        # Those that come first are far from each other.
        along, aside = divmod(number * 7 % PILLARS, 6)
        x, y = 88 + 76 * along, 38 + 82 * aside
        mirror = 0.5 * (number % 3 == 0)
        rects += [
            Rectangle(corners=corners, colour=(200, 90, 60), mirror=mirror)
            for corners in sides((x, y, 0), (x + 24, y + 24, 160))
        ]
    return Scene(camera=Camera(position=(8, 256, 60)), rect=tuple(rects[:count]), reflections=reflections)


def sides(low: tuple[int, ...], high: tuple[int, ...]) -> list[tuple[Any, Any]]:
    """Return the corners of a box's four upright sides."""
    (x_0, y_0, z_0), (x_1, y_1, z_1) = low, high
    ends = (((x_0, y_0), (x_0, y_1)), ((x_1, y_0), (x_1, y_1)), ((x_0, y_0), (x_1, y_0)), ((x_0, y_1), (x_1, y_1)))
    return [((*start, z_0), (*stop, z_1)) for start, stop in ends]


BEAM = "beam engine of version 1.0"
"""An engine that took a cycle per column, and up to 32 rectangles."""


def exact_cycles(columns: int, rectangles: int, reflections: int) -> int:
    """Return the cycles of a row in a unit of the exact engine."""
    config = configure(engine="exact", units=1, rectangles=rectangles, reflections=reflections, allow_underrun=True)
    return columns * EXACT.group_cycles(config)


@styled
def rectangles_picture() -> Figure:
    """Draw the mean cycles of a row against the rectangles of its scene."""
    figure, axes = new_figure(2.8)
    ax: Axes = axes[0, 0]
    for marker, reflections in zip("os", (0, 1), strict=True):
        points = [(count, mean_cycles(pillars(count, reflections), SIZES[0])) for count in COUNTS]
        label = f"hall of pillars, {reflections} reflection{'s' * (reflections != 1)}"
        ax.plot(*zip(*points, strict=True), marker=marker, color=SPAN.facts.colour, markersize=4, label=label)
    scenes = [scene for scene in map(load_scene, packaged_scenes().values()) if not scene.light]
    cycles = [(len(scene.rect), mean_cycles(scene, SIZES[0])) for scene in scenes]
    ax.plot(*zip(*cycles, strict=True), "x", color=BLUE, markersize=4, label="packaged scenes without a light")
    most = [count for count in COUNTS if count <= EXACT.facts.rectangles]
    slow = [exact_cycles(SIZES[0], count, 0) for count in most]
    ax.plot(most, slow, color=EXACT.facts.colour, linestyle="--", label="exact engine, 0 reflections")
    ax.plot(most[:: len(most) - 1], 2 * [SIZES[0]], color=GREY, linestyle=":", label=BEAM)
    ax.plot(COUNTS[::5], 2 * [CLOCKS], color=GREY, linestyle="-.", label="60 frames of 240 rows at 25 MHz")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ticks(ax.xaxis)
    ticks(ax.yaxis)
    ax.set_xlabel("rectangles")
    ax.set_ylabel("cycles per row of one unit")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


@styled
def cycles_picture() -> Figure:
    """Draw the mean cycles of a row against its columns."""
    figure, axes = new_figure(2.8)
    ax: Axes = axes[0, 0]
    for marker, (name, reflections, points) in zip("os^", measured(), strict=True):
        label = f"{name}, {reflections} reflection{'s' * (reflections != 1)}"
        ax.plot(*zip(*points, strict=True), marker=marker, color=SPAN.facts.colour, markersize=4, label=label)
    scene = load_scene(packaged_scenes()[MEASURED[1]])
    slow = [exact_cycles(columns, len(scene.rect), scene.reflections) for columns in SIZES]
    ax.plot(SIZES, slow, color=EXACT.facts.colour, linestyle="--", label=f"exact engine, {MEASURED[1]}")
    ax.plot(SIZES, SIZES, color=GREY, linestyle=":", label=BEAM)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ticks(ax.xaxis)
    ticks(ax.yaxis)
    ax.set_xlabel("columns")
    ax.set_ylabel("cycles per row of one unit")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def pictures() -> dict[str, Figure]:
    """Return the page's pictures, by name."""
    return {
        "span_row": row_picture(),
        "span_fold": fold_picture(),
        "span_cycles": cycles_picture(),
        "span_rectangles": rectangles_picture(),
    }
