# SPDX-License-Identifier: MIT
"""Pages of the report: a self-contained one for a browser, and one in Markdown next to the plots."""

from __future__ import annotations

import base64
import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

TEMPLATE = Path(__file__).with_name("page.html.jinja")
TITLE = "RayCaster: error against run time"
Cell = str | int | float | None


@dataclass(frozen=True)
class Plot:
    """A plot, `<name>.svg`, and the numbers that it shows, `<numbers>.csv`."""

    name: str
    caption: str
    numbers: str = ""
    """Name of the CSV file without its suffix; empty if it is `name`."""

    @property
    def csv(self) -> str:
        """Name of the CSV file, without its suffix."""
        return self.numbers or self.name


@dataclass(frozen=True)
class Table:
    """A sortable table; `<name>.csv` has all columns."""

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True)
class Section:
    """A heading with its content."""

    title: str
    text: str = ""
    sentences: Sequence[str] = ()
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()


@dataclass(frozen=True)
class Page:
    """Contents of the whole page."""

    alarms: Sequence[str]
    """Faults, each shown as a red line at the top."""

    summary: Sequence[str]
    sections: Sequence[Section]


def show(cell: Cell) -> str:
    """Convert a cell to text; numbers are rounded to significant digits."""
    if cell is None:
        return ""
    if isinstance(cell, str):
        return cell
    return f"{cell:,}" if isinstance(cell, int) else f"{cell:.3g}" if cell < 1000 else f"{cell:,.0f}"


def write_html(page: Page, directory: Path) -> Path:
    """Write `index.html`, which embeds the plots and the CSV files."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(TEMPLATE.read_text())
    path = directory / "index.html"
    path.write_text(
        template.render(
            title=TITLE,
            page=page,
            show=show,
            svg=lambda name: _inline(directory, name),
            data=lambda name: base64.b64encode((directory / f"{name}.csv").read_bytes()).decode(),
        )
    )
    return path


def _inline(directory: Path, name: str) -> Markup:
    """Read an SVG for embedding: make its identifiers unique on the page, and remove its size, which CSS sets."""
    svg = (directory / f"{name}.svg").read_text()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'href="#', f'href="#{name}-', svg)
    svg = re.sub(r"url\(#", f"url(#{name}-", svg)
    return Markup(re.sub(r'(<svg[^>]*?) width="[^"]*pt"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*pt"', r"\1", svg)))


def write_markdown(page: Page, directory: Path) -> Path:
    """Write `report.md`, which links to the plots next to it."""
    parts = [f"# {TITLE}", *(f"**{alarm}**" for alarm in page.alarms)]
    parts.append("\n".join(f"- {sentence}" for sentence in page.summary))
    for section in page.sections:
        parts.append(f"## {section.title}")
        parts += [section.text] if section.text else []
        parts += ["\n".join(f"- {sentence}" for sentence in section.sentences)] if section.sentences else []
        parts += [f"![{plot.name}]({plot.name}.svg)\n\n*{plot.caption}* [{plot.csv}.csv]({plot.csv}.csv)"
                  for plot in section.plots]  # fmt: skip
        for table in section.tables:
            texts = [[show(cell) for cell in row] for row in table.rows]
            lines = [table.columns, ["---"] * len(table.columns), *texts]
            parts.append("\n".join(f"| {' | '.join(line)} |" for line in lines))
    path = directory / "report.md"
    path.write_text("\n\n".join(parts) + "\n")
    return path


def write_csv(columns: Sequence[str], rows: Sequence[Sequence[Cell]], path: Path) -> None:
    """Write a table as CSV, with all digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    path.write_text(text.getvalue())
