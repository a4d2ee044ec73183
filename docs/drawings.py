# SPDX-License-Identifier: MIT
"""The diagrams beside the pages, `docs/diagrams/*.svg`, kept so that a page shows them wherever it is read."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from raycaster.docs import blocks, timing
from raycaster.outcomes import RESULTS, kept_outcome
from raycaster.report import plots
from raycaster.report.designs import error_and_time, of_kept

DIAGRAMS = Path(__file__).parent / "diagrams"


def drawn() -> dict[str, str]:
    """Every diagram as SVG, by its name."""
    found = {drawing.name: blocks.draw(drawing) for drawing in blocks.DRAWINGS}
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        for diagram in timing.DIAGRAMS:
            path = Path(scratch) / f"{diagram.name}.svg"
            timing.render(timing.kept(diagram.name), path)
            found[diagram.name] = path.read_text()
        path = Path(scratch) / "error_and_time.svg"
        plots.save(error_and_time(of_kept(kept_outcome(RESULTS / "report.json").figures["designs"])), path)
        found[path.stem] = path.read_text()
    return found


def words(svg: str) -> list[str]:
    """What a diagram says, without where it is: another machine's fonts move everything a little."""
    return sorted(re.findall(r"<(?:title|text|tspan)\b[^>]*>([^<]+)<", svg))


def draw_all() -> list[Path]:
    """Write the diagrams that say something else than those that are kept.

    Returns:
        What was written.
    """
    changed = []
    for name, svg in drawn().items():
        path = DIAGRAMS / f"{name}.svg"
        if not path.exists() or words(path.read_text()) != words(svg):
            path.parent.mkdir(exist_ok=True)
            path.write_text(svg)
            changed.append(path)
    return changed
