# SPDX-License-Identifier: MIT
"""Chapter on savings, in cells and cycles, from leaving out what a scene does not need."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.design import design_for
from raycaster.engines import ENGINES
from raycaster.report import hardware, plots
from raycaster.report.extent import Extent
from raycaster.report.page import Plot, Section, Table, write_csv
from raycaster.report.points import CellsPoint, LeftPoint, Point, TimePoint, View, command, leaving_out
from raycaster.report.sweep import Sweep

COLUMNS = (
    "scene", "left out", "LUT4", "registers", "multipliers", "units", "cycles per frame", "clock MHz", "ms per frame",
)  # fmt: skip
CULLING_COLUMNS = (
    "scene", "engine", "rectangles", "reflections", "cycles without culling", "cycles with culling", "share",
    "pixels unlike the model",
)  # fmt: skip


def omission_sections(
    what: Extent, scenes: Sequence[View], directory: Path, sweep: Sweep
) -> tuple[list[Section], list[str], str]:
    """Write the plots and tables of the chapter, and return its sections, alarms and summary sentence."""
    sections, alarms, summary = [], [], "This quick report does not measure the savings from leaving parts out."
    if what.left_scenes:
        section, summary = _left(what, scenes[: what.left_scenes], directory, sweep)
        sections.append(section)
    if what.culled:
        section, alarms = _culling(what, scenes, directory, sweep)
        sections.append(section)
    return sections, alarms, summary


def _point(view: View, engine: str, step: int, config: Configuration) -> Point:
    """Return the point that counts a step's cells; designs for any scene share one between scenes."""
    return LeftPoint(view, engine, step) if config.fixed else CellsPoint(config)


def _left(what: Extent, scenes: Sequence[View], directory: Path, sweep: Sweep) -> tuple[Section, str]:
    steps = {view: list(leaving_out(view, what.left_engine)) for view in scenes}
    points = {
        (view, step): _point(view, what.left_engine, step, config)
        for view, several in steps.items()
        for step, (_, config) in enumerate(several)
    }
    found = sweep("reduced designs", list(dict.fromkeys(points.values())))
    rows, drawn, remaining = [], [], {}
    for view, several in steps.items():
        counts = [found[points[view, step]] for step in range(len(several))]
        for (step, (name, config)), count in zip(enumerate(several), counts, strict=True):
            cycles = hardware.predicted_cycles(config)
            clock = config.screen_geometry.clock_hz
            row = [view.name, name if step else "", *(count[kind] for kind in ("cells", "registers", "multipliers"))]
            rows.append([*row, config.units, cycles, clock / 1e6, 1000 * cycles / clock, command(points[view, step])])
        figure = f"left_{view.name}"
        waterfall = [(name, count["cells"]) for (name, _), count in zip(several, counts, strict=True)]
        plots.save(plots.waterfall(view.name, waterfall), directory / f"{figure}.svg")
        write_csv((*COLUMNS, "command"), rows[-len(several) :], directory / f"{figure}.csv")
        drawn.append(Plot(figure, f"{view.name}, starting from {several[0][1].name}."))
        remaining[view.name] = counts[-1]["cells"] / counts[0]["cells"], counts[-1], counts[0]
    write_csv((*COLUMNS, "command"), rows, directory / "left.csv")
    least, most = (of(remaining, key=lambda name: remaining[name][0]) for of in (min, max))
    summary = (
        f"Without the parts that a scene does not need, {remaining[least][0]:.0%} ({least}, "
        f"{remaining[least][1]['cells']:,} LUT4) to {remaining[most][0]:.0%} ({most}, "
        f"{remaining[most][1]['cells']:,} LUT4) of the {what.left_engine} engine for any scene remain."
    )
    text = (
        f"The {what.left_engine} engine for any scene has reflections, turned cameras, mirrors of any strength, "
        "patterns and a light. Each step removes one thing that the scene does not need from the previous design. "
        "Designs have just enough units to meet the row budget; a step that saves time can thus save units. Cycles are "
        "for the worst case, and the clock is the required one. Steps that change no cells are missing from the plots. "
        "Cells were counted by Yosys, before placement."
    )
    section = Section(
        "Savings from leaving parts out", text, plots=drawn, tables=[Table("left", COLUMNS, [r[:-1] for r in rows])]
    )
    return section, summary


def _culling(what: Extent, scenes: Sequence[View], directory: Path, sweep: Sweep) -> tuple[Section, list[str]]:
    """Compare the cycles per frame with and without culling, for every scene."""
    points = {}
    for engine in what.culled:
        for scene in scenes:
            if scene.scene.lacks(ENGINES[engine].looks):
                continue
            for culling in (False, True):
                options = {"engine": engine, "screen": what.screen, "culling": culling}
                design = design_for(Path(scene.source), options)
                points[engine, scene, culling] = TimePoint(scene, design.configuration)
    found = sweep("culling", list(points.values()))
    shares: dict[str, dict[str, float]] = {engine: {} for engine in what.culled}
    rows = []
    for engine, scene, culling in points:
        if not culling:
            continue
        without, with_it = (found[points[engine, scene, one]] for one in (False, True))
        share = with_it["frame_cycles"] / without["frame_cycles"]
        shares[engine][scene.name] = share
        point = points[engine, scene, True]
        rows.append(
            [
                scene.name, engine, len(scene.scene.rect), point.config.reflections, without["frame_cycles"],
                with_it["frame_cycles"], share, without["wrong"] + with_it["wrong"], command(point),
            ]
        )  # fmt: skip
    plots.save(plots.culling(shares), directory / "culling.svg")
    write_csv((*CULLING_COLUMNS, "command"), rows, directory / "culling.csv")
    wrong = sum(row[7] for row in rows)
    alarms = [f"With or without culling, {wrong} pixels differ from the golden model."] if wrong else []
    text = (
        "Computing a frame takes fewer system cycles with culling, because rectangles that no ray of a group can hit "
        "are abandoned early. The worst case, which must meet the row budget, is unchanged."
    )
    plot = Plot("culling", "Cycles per frame with culling, relative to those without.")
    return Section("Savings from culling", text, plots=[plot],
                   tables=[Table("culling", CULLING_COLUMNS, [row[:-1] for row in rows])]), alarms  # fmt: skip
