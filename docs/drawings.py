# SPDX-License-Identifier: MIT
"""Diagrams of the pages, `docs/diagrams/*.svg`, stored so that every viewer of a page shows them."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Any

import wavedrom

from raycaster.docs import blocks, spans, timing
from raycaster.report import plots
from raycaster.report.designs import of_kept, work_precision
from raycaster.runs.outcomes import RESULTS, kept_outcome

DIAGRAMS = Path(__file__).parent / "diagrams"


def drawn() -> dict[str, str]:
    """Return every diagram as SVG, by name."""
    found = {drawing.name: blocks.draw(drawing) for drawing in blocks.DRAWINGS}
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        for diagram in timing.DIAGRAMS:
            path = Path(scratch) / f"{diagram.name}.svg"
            drawing: Any = wavedrom.render(timing.kept(diagram.name))
            drawing.saveas(str(path))
            found[diagram.name] = path.read_text()
        for name, figure in spans.pictures().items():
            path = Path(scratch) / f"{name}.svg"
            plots.save(figure, path)
            found[name] = path.read_text()
        path = Path(scratch) / "error_and_time.svg"
        designs = of_kept(kept_outcome(RESULTS / "report.json").figures["designs"])
        # The marks in words, which `words` compares: otherwise a mark could move unseen.
        marks = "; ".join(f"{one.title}: {one.frame_ms:.3g} ms, {one.error:.3%} wrong" for one in designs)
        plots.save(work_precision(designs, "frame_ms"), path, Title=marks)
        found[path.stem] = path.read_text()
    return found


def words(svg: str) -> list[str]:
    """Return the texts of a diagram without their positions, which depend on the machine's fonts."""
    return sorted(re.findall(r"<(?:title|text|tspan)\b[^>]*>([^<]+)<", svg))


def draw_all() -> list[Path]:
    """Write the diagrams whose texts differ from the stored ones.

    Returns:
        The paths of the written files.
    """
    changed = []
    for name, svg in drawn().items():
        path = DIAGRAMS / f"{name}.svg"
        if not path.exists() or words(path.read_text()) != words(svg):
            path.parent.mkdir(exist_ok=True)
            path.write_text(svg)
            changed.append(path)
    return changed
