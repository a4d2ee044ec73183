# SPDX-License-Identifier: MIT
"""The report's pages: one for a browser, which needs nothing else, and one in Markdown beside the plots."""

from __future__ import annotations

import base64
import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jinja2 import Environment, StrictUndefined

TEMPLATE = Path(__file__).with_name("page.html.jinja")
Cell = str | int | float | None


@dataclass
class Section:
    """A heading, and what stands below it."""

    title: str
    text: str = ""
    sentences: Sequence[str] = ()
    plot: str = ""
    """File name of a PNG."""

    columns: Sequence[str] = ()
    rows: Sequence[Sequence[Cell]] = field(default_factory=list)


def show(cell: Cell) -> str:
    """A cell as text: numbers with as many digits as say something."""
    if cell is None:
        return ""
    if isinstance(cell, int):
        return f"{cell:,}"
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)


def write_html(introduction: str, sections: Sequence[Section], directory: Path) -> Path:
    """Write `index.html`, the plots in it."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    images = {
        section.plot: base64.b64encode((directory / section.plot).read_bytes()).decode()
        for section in sections
        if section.plot
    }
    page = environment.from_string(TEMPLATE.read_text())
    path = directory / "index.html"
    path.write_text(page.render(introduction=introduction, sections=sections, images=images, show=show))
    return path


def write_markdown(introduction: str, sections: Sequence[Section], directory: Path) -> Path:
    """Write `report.md`, which shows the plots beside it."""
    parts = ["# RayCaster: error against run time", introduction]
    for section in sections:
        parts.append(f"## {section.title}")
        parts += [section.text] if section.text else []
        parts += ["\n".join(f"- {sentence}" for sentence in section.sentences)] if section.sentences else []
        parts += [f"![{section.title}]({section.plot})"] if section.plot else []
        if section.rows:
            texts = [[show(cell) for cell in row] for row in section.rows]
            lines = [section.columns, ["---"] * len(section.columns), *texts]
            parts.append("\n".join(f"| {' | '.join(line)} |" for line in lines))
    path = directory / "report.md"
    path.write_text("\n\n".join(parts) + "\n")
    return path


def write_csv(columns: Sequence[str], rows: Sequence[Sequence[Cell]], path: Path) -> None:
    """Write a table with every digit."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)
