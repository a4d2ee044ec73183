# SPDX-License-Identifier: MIT
"""The chapter of what scenes do not need: what leaving it out saves, in cells and in cycles."""

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
    "scene", "without", "LUT4", "registers", "multipliers", "units", "cycles of a frame", "clock MHz", "frame, ms",
)  # fmt: skip
CULLING_COLUMNS = (
    "scene", "engine", "rectangles", "reflections", "cycles without", "cycles with", "share", "wrong against golden",
)  # fmt: skip


def omission_sections(
    what: Extent, scenes: Sequence[View], directory: Path, sweep: Sweep
) -> tuple[list[Section], list[str], str]:
    """The sections, alarms, and what a reader should know in one sentence."""
    sections, alarms, summary = [], [], "What leaving out buys was not looked at in this quick report."
    if what.left_scenes:
        section, summary = _left(what, scenes[: what.left_scenes], directory, sweep)
        sections.append(section)
    if what.culled:
        section, alarms = _culling(what, scenes, directory, sweep)
        sections.append(section)
    return sections, alarms, summary


def _point(view: View, engine: str, step: int, config: Configuration) -> Point:
    """Designs for any scene are the same for many."""
    return LeftPoint(view, engine, step) if config.fixed else CellsPoint(config)


def _left(what: Extent, scenes: Sequence[View], directory: Path, sweep: Sweep) -> tuple[Section, str]:
    steps = {view: list(leaving_out(view, what.left_engine)) for view in scenes}
    points = {
        (view, step): _point(view, what.left_engine, step, config)
        for view, several in steps.items()
        for step, (_, config) in enumerate(several)
    }
    found = sweep("what is left", list(dict.fromkeys(points.values())))
    rows, drawn, remaining = [], [], {}
    for view, several in steps.items():
        counts = [found[points[view, step]] for step in range(len(several))]
        for (step, (name, config)), count in zip(enumerate(several), counts, strict=True):
            cycles = hardware.foretold_cycles(config)
            clock = config.screen_geometry.clock_hz
            row = [view.name, name if step else "", *(count[kind] for kind in ("cells", "registers", "multipliers"))]
            rows.append([*row, config.units, cycles, clock / 1e6, 1000 * cycles / clock, command(points[view, step])])
        figure = f"left_{view.name}"
        waterfall = [(name, count["cells"]) for (name, _), count in zip(several, counts, strict=True)]
        plots.save(plots.waterfall(view.name, waterfall), directory / f"{figure}.svg")
        write_csv((*COLUMNS, "command"), rows[-len(several) :], directory / f"{figure}.csv")
        drawn.append(Plot(figure, f"{view.name}: from {several[0][1].name} on."))
        remaining[view.name] = counts[-1]["cells"] / counts[0]["cells"], counts[-1], counts[0]
    write_csv((*COLUMNS, "command"), rows, directory / "left.csv")
    least, most = (of(remaining, key=lambda name: remaining[name][0]) for of in (min, max))
    summary = (
        f"Leaving out what a scene does not need leaves {remaining[least][0]:.0%} ({least}, "
        f"{remaining[least][1]['cells']:,} LUT4) to {remaining[most][0]:.0%} ({most}, "
        f"{remaining[most][1]['cells']:,}) of "
        f"the {what.left_engine} engine that draws any scene."
    )
    text = (
        f"The {what.left_engine} engine for any scene has reflections, turned cameras, mirrors of any strength and "
        "patterns. Each step leaves out what the scene does not need, of the design before. As many units as meet the "
        "row budget; cycles are the worst case's; the clock is the required one. A step that is not in a plot leaves "
        "nothing out, though it may make the units fewer by leaving time. Counted by Yosys, before placing."
    )
    section = Section(
        "What leaving out buys", text, plots=drawn, tables=[Table("left", COLUMNS, [r[:-1] for r in rows])]
    )
    return section, summary


def _culling(what: Extent, scenes: Sequence[View], directory: Path, sweep: Sweep) -> tuple[Section, list[str]]:
    """Cycles of a frame of every scene without culling and with it."""
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
    alarms = [f"With culling or without, {wrong} pixels are not golden's."] if wrong else []
    text = (
        "System cycles in which a frame is computed, without culling and with it: what no ray of a group can hit is "
        "given up early. The worst case, which the row budget is for, stays."
    )
    plot = Plot("culling", "Cycles of a frame with culling, of those without.")
    return Section("What culling saves", text, plots=[plot],
                   tables=[Table("culling", CULLING_COLUMNS, [row[:-1] for row in rows])]), alarms  # fmt: skip
