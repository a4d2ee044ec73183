# SPDX-License-Identifier: MIT
"""Chapter on savings, in cells and cycles, from leaving out what a scene does not need."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from raycaster.configuration import Configuration, configure
from raycaster.convert.take_home import TOP
from raycaster.design import design_for
from raycaster.engines import ENGINES
from raycaster.report import hardware, plots
from raycaster.report.extent import Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import Point, leaving_out, name_of, scene_of
from raycaster.report.sweep import Sweep

COLUMNS = (
    "scene", "left out", "LUT4", "registers", "multipliers", "units", "cycles per frame", "clock MHz", "ms per frame",
    "command",
)  # fmt: skip
CULLING_COLUMNS = (
    "scene", "engine", "rectangles", "reflections", "cycles without culling", "cycles with culling", "share",
    "pixels unlike the model", "command",
)  # fmt: skip


def omission_chapter(what: Extent, sources: Sequence[str], sweep: Sweep) -> Chapter:
    """Return the chapter."""
    left = _left(what, sources[: what.left_scenes], sweep)
    return left + _culling(what, sources, sweep) if what.culled else left


def _left(what: Extent, sources: Sequence[str], sweep: Sweep) -> Chapter:
    if not sources:
        return Chapter(summary=["This quick report does not measure the savings from leaving parts out."])
    steps = {source: list(leaving_out(source, what.left_engine)) for source in sources}

    def point(source: str, step: int, config: Configuration) -> Point:
        """Return the point that counts a step's cells; designs for any scene share one between scenes."""
        return (
            Point("left", source, configure(engine=what.left_engine), step)
            if config.fixed
            else Point("cells", TOP, config)
        )

    points = {
        source: [point(source, step, config) for step, (_, config) in enumerate(several)]
        for source, several in steps.items()
    }
    found = sweep("reduced designs", [one for several in points.values() for one in several])
    rows, drawn, remaining = [], [], {}
    for source, several in steps.items():
        counts = [found[one] for one in points[source]]
        of_scene = []
        for (part, config), count, one in zip(several, counts, points[source], strict=True):
            cycles = hardware.predicted_cycles(config)
            clock = config.screen_geometry.clock_hz
            row = [
                name_of(source),
                part if of_scene else "",
                *(count[k] for k in ("cells", "registers", "multipliers")),
            ]
            of_scene.append([*row, config.units, cycles, clock / 1e6, 1000 * cycles / clock, one.command])
        rows += of_scene
        name = name_of(source)
        sizes = [count["cells"] for count in counts]
        waterfall = plots.waterfall(name, list(zip(dict(several), sizes, strict=True)))
        data = Data(f"left_{name}", COLUMNS, of_scene)
        drawn.append(Plot(data.name, f"{name}, starting from {several[0][1].name}.", waterfall, data))
        remaining[name] = sizes[-1] / sizes[0], sizes[-1]
    least, most = (
        f"{share:.0%} ({name}, {cells:,} LUT4)"
        for name, (share, cells) in (of(remaining.items(), key=lambda one: one[1][0]) for of in (min, max))
    )
    summary = (
        f"Without the parts that a scene does not need, {least} to {most} of the {what.left_engine} engine for any "
        "scene remain."
    )
    text = (
        f"The {what.left_engine} engine for any scene has reflections, turned cameras, mirrors of any strength, "
        "patterns and a light. Each step removes one thing that the scene does not need from the previous design. "
        "Designs have just enough units to meet the row budget; a step that saves time can thus save units. Cycles are "
        "for the worst case, and the clock is the required one. Steps that change no cells are missing from the plots. "
        "Cells were counted by Yosys, before placement."
    )
    tables = [Table.of(Data("left", COLUMNS, rows), hidden=1)]
    return Chapter([Section("Savings from leaving parts out", text, plots=drawn, tables=tables)], summary=[summary])


def _culling(what: Extent, sources: Sequence[str], sweep: Sweep) -> Chapter:
    """Compare the cycles per frame with and without culling, for every scene."""
    points = {}
    for engine in what.culled:
        for source in sources:
            if not scene_of(source).lacks(ENGINES[engine].looks):
                options = {"engine": engine, "screen": what.screen}
                points[engine, source] = [
                    Point("time", source, design_for(Path(source), options | {"culling": culling}).configuration)
                    for culling in (False, True)
                ]
    found = sweep("culling", [point for pair in points.values() for point in pair])
    shares: dict[str, dict[str, float]] = {engine: {} for engine in what.culled}
    rows = []
    for (engine, source), (plain, culled) in points.items():
        without, with_it = found[plain], found[culled]
        share = with_it["frame_cycles"] / without["frame_cycles"]
        shares[engine][name_of(source)] = share
        rows.append(
            [
                name_of(source), engine, len(scene_of(source).rect), culled.config.reflections, without["frame_cycles"],
                with_it["frame_cycles"], share, without["wrong"] + with_it["wrong"], culled.command,
            ]
        )  # fmt: skip
    data = Data("culling", CULLING_COLUMNS, rows)
    wrong = sum(row[-2] for row in rows)
    alarms = [f"With or without culling, {wrong} pixels differ from the golden model."] if wrong else []
    text = (
        "Computing a frame takes fewer system cycles with culling, because rectangles that no ray of a group can hit "
        "are abandoned early. The worst case, which must meet the row budget, is unchanged."
    )
    plot = Plot("culling", "Cycles per frame with culling, relative to those without.", plots.culling(shares), data)
    return Chapter([Section("Savings from culling", text, plots=[plot], tables=[Table.of(data, hidden=1)])], alarms)
