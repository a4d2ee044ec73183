# SPDX-License-Identifier: MIT
"""The report's pages: one for a browser, which needs nothing else, and one in Markdown beside the plots."""

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
    """An SVG, `<name>.svg`, and the numbers that it shows, `<numbers>.csv`."""

    name: str
    caption: str
    numbers: str = ""
    """The name, where it is not given."""

    @property
    def csv(self) -> str:
        """Name of the file of numbers, without its suffix."""
        return self.numbers or self.name


@dataclass(frozen=True)
class Table:
    """Rows below headings, which a reader can sort; all columns of them are in `<name>.csv`."""

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True)
class Section:
    """A heading, and what stands below it."""

    title: str
    text: str = ""
    sentences: Sequence[str] = ()
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()


@dataclass(frozen=True)
class Page:
    """All of it."""

    alarms: Sequence[str]
    """What must not be: each a red line at the top."""

    summary: Sequence[str]
    sections: Sequence[Section]


def show(cell: Cell) -> str:
    """A cell as text: numbers with as many digits as say something."""
    if cell is None:
        return ""
    if isinstance(cell, str):
        return cell
    return f"{cell:,}" if isinstance(cell, int) else f"{cell:.3g}" if cell < 1000 else f"{cell:,.0f}"


def write_html(page: Page, directory: Path) -> Path:
    """Write `index.html`, with the plots and the CSV files in it."""
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
    """An SVG for a page of several: its identifiers are its own, and its size is the page's to say."""
    svg = (directory / f"{name}.svg").read_text()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'href="#', f'href="#{name}-', svg)
    svg = re.sub(r"url\(#", f"url(#{name}-", svg)
    return Markup(re.sub(r'(<svg[^>]*?) width="[^"]*pt"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*pt"', r"\1", svg)))


def write_markdown(page: Page, directory: Path) -> Path:
    """Write `report.md`, which shows the plots beside it."""
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
    """Write a table with every digit."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    path.write_text(text.getvalue())
