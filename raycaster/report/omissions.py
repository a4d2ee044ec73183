# SPDX-License-Identifier: MIT
"""Chapter on the cells and cycles that leaving out what a scene does not need saves."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.design.decide import configure
from raycaster.report import plots
from raycaster.report.extent import Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import LEFT_UNITS, Point, Sweep, name_of

COLUMNS = (
    "scene", "left out", "LUT4", "registers", "multipliers", "units needed", "cycles per frame", "clock MHz",
    "ms per frame", "command",
)  # fmt: skip


def omission_chapter(what: Extent, scenes: Sequence[str], sweep: Sweep) -> Chapter:
    """Return the chapter, for those of the packaged scenes that are in the extent."""
    sources = [source for source in scenes if name_of(source) in what.left]
    if not sources:
        return Chapter(summary=["This quick report does not measure the savings from leaving parts out."])
    engine = configure(engine="exact")
    found = sweep("reduced designs", [Point("left", source, engine) for source in sources])
    rows, drawn, remaining = [], [], {}
    for point, result in found.items():
        name = name_of(point.what)
        of_scene = []
        for one in result["steps"]:
            counts = [one[key] for key in ("left_out", "cells", "registers", "multipliers", "units", "cycles")]
            of_scene.append([name, *counts, one["clock_mhz"], one["cycles"] / one["clock_mhz"] / 1000, point.command])
        rows += of_scene
        sizes = [(one["left_out"] or "any scene", one["cells"]) for one in result["steps"]]
        data = Data(f"left_{name}", COLUMNS, of_scene)
        drawn.append(Plot(data.name, f"{name}: cells after each step.", plots.waterfall(name, sizes), data))
        remaining[sizes[-1][1] / sizes[0][1]] = f"{name}, {sizes[-1][1]:,} LUT4"
    least, most = (f"{share:.0%} ({remaining[share]})" for share in (min(remaining), max(remaining)))
    summary = (
        f"Without the parts that a scene does not need, {least} to {most} of the exact engine for any scene remain."
    )
    text = (
        f"The exact engine for any scene has reflections, turned cameras, mirrors of any strength, "
        "patterns and a light. Each step removes one thing that the scene does not need from the previous design. "
        f"All have {LEFT_UNITS} units, so that a step's cells are those of the part; its time shows in the cycles per "
        "frame, which are for the worst case, and in the fewest units that meet the row budget. The clock is the "
        "required one. Steps that change no cells are missing from the plots. Cells were counted by Yosys, before "
        "placement."
    )
    tables = [Table.of(Data("left", COLUMNS, rows), hidden=1)]
    return Chapter([Section("What leaving out buys", text, plots=drawn, tables=tables)], summary=[summary])
