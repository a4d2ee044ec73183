# SPDX-License-Identifier: MIT
"""Page of the report, self-contained, for a browser and for print, with its plots and tables in files next to it."""

from __future__ import annotations

import base64
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup, escape
from matplotlib.figure import Figure

from raycaster.report import plots

TEMPLATE = Path(__file__).with_name("page.html.jinja")
TITLE = "RayCaster: error against run time"
Cell = str | int | float | None


@dataclass(frozen=True)
class Data:
    """Numbers of plots and tables, written with all digits to `<name>.csv`."""

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]

    def write(self, directory: Path) -> None:
        """Write the file."""
        with (directory / f"{self.name}.csv").open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows(self.rows)


@dataclass(frozen=True)
class Plot:
    """A plot, written to `<name>.svg`, and the numbers that it shows."""

    name: str
    caption: str
    figure: Figure
    data: Data


@dataclass(frozen=True)
class Table:
    """A sortable table, which shows a part of its data."""

    data: Data
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]

    @classmethod
    def of(cls, data: Data) -> Table:
        """Make the table of all rows and columns."""
        return cls(data, data.columns, data.rows)


@dataclass(frozen=True)
class Section:
    """A heading with its content."""

    title: str
    text: str = ""
    sentences: Sequence[str] = ()
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()


@dataclass(frozen=True)
class Chapter:
    """Sections on one subject; the whole page consists of several chapters."""

    sections: list[Section] = field(default_factory=list)
    alarms: list[str] = field(default_factory=list)
    """Faults, each shown as a red line at the top."""

    summary: list[str] = field(default_factory=list)
    """Sentences for the top of the page."""

    def __add__(self, other: Chapter) -> Chapter:
        """Append another chapter."""
        return Chapter(*(mine + theirs for mine, theirs in zip(vars(self).values(), vars(other).values(), strict=True)))


def write(page: Chapter, directory: Path) -> Path:
    """Write the plots and the data, and `index.html`, which embeds all; return its path."""
    for section in page.sections:
        for each in (*section.plots, *section.tables):
            each.data.write(directory)
        for plot in section.plots:
            plots.save(plot.figure, directory / f"{plot.name}.svg")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["code"] = lambda text: Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text))))
    names = {
        "title": TITLE, "page": page, "show": show, "svg": lambda name: _inline(directory, name),
        "encoded": lambda data: base64.b64encode((directory / f"{data.name}.csv").read_bytes()).decode(),
    }  # fmt: skip
    path = directory / "index.html"
    path.write_text(environment.from_string(TEMPLATE.read_text()).render(names))
    return path


def show(cell: Cell) -> str:
    """Convert a cell to text; numbers are rounded to significant digits."""
    if cell is None or isinstance(cell, str):
        return cell or ""
    return f"{cell:,}" if isinstance(cell, int) else f"{cell:.3g}" if cell < 1000 else f"{cell:,.0f}"


def _inline(directory: Path, name: str) -> Markup:
    """Read an SVG for embedding: make its identifiers unique on the page, and remove its size, which CSS sets."""
    svg = (directory / f"{name}.svg").read_text()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'(\bid="|href="#|url\(#)', rf"\1{name}-", svg)
    return Markup(re.sub(r'(?<= )(width|height)="[^"]*pt" ', "", svg, count=2))
