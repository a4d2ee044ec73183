# SPDX-License-Identifier: MIT
"""Growth of cells, cycles and simulation time with rectangles and reflections."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure
from rich.progress import track

from raycaster.configuration import MOST_RECTANGLES, MOST_REFLECTIONS, Configuration, ConfigurationError, configure
from raycaster.convert.provenance import Provenance
from raycaster.engines import ENGINES
from raycaster.fpga.cells import DECIDES, FAMILIES, TOOLS, Area, measure
from raycaster.golden.engines import model_of
from raycaster.golden.picture import count_wrong, shown
from raycaster.jobs import run_jobs, threads
from raycaster.outcomes import Outcome, Published, table
from raycaster.output import Console
from raycaster.play.machine import Machine, build_machine
from raycaster.play.walk import Walker
from raycaster.scene import Scene, load_scene, packaged_scenes

FAMILY = FAMILIES["ecp5"]
JOBS = 2
FEW, MANY = 2, 12
"""Numbers of frames in two runs, whose difference in time gives the time per frame."""


@dataclass(frozen=True)
class Series:
    """Designs of one engine that differ in one option; all others have their defaults."""

    engine: str
    option: str
    values: Sequence[int]


RECTANGLES = (4, 12, MOST_RECTANGLES)
REFLECTIONS = (0, 1, 2, MOST_REFLECTIONS)
SERIES = (
    *(Series(engine, "rectangles", RECTANGLES) for engine in ENGINES),
    *(Series(engine, "reflections", REFLECTIONS) for engine in ENGINES),
)


def _designs() -> Iterator[tuple[dict[str, Any], Configuration | ConfigurationError]]:
    """Yield the engine, the option and its value for each design of `SERIES`, and the design or why it is refused."""
    for series in SERIES:
        for value in series.values:
            row = {"engine": series.engine, "option": series.option, "value": value}
            try:
                yield row, configure(**{"engine": series.engine, series.option: value})
            except ConfigurationError as error:
                yield row, error


def provenance() -> Provenance:
    """Return the designs, sources and tools that decide these figures."""
    designs = [design for _, design in _designs() if isinstance(design, Configuration)]
    return Provenance(designs, [*DECIDES, "sim/main.cpp", "play/machine.cpp"], [*TOOLS, "verilator"])


def scene_for(config: Configuration) -> Scene:
    """Return a scene that fills the design's rectangle table with rectangles from the packaged scenes."""
    scenes = [load_scene(path) for path in packaged_scenes(plain=True).values()]
    rectangles = [rectangle for scene in scenes for rectangle in scene.rect][: config.rectangles]
    return scenes[0].model_copy(update={"rect": tuple(rectangles), "reflections": config.reflections})


def frame_time(config: Configuration, build: Path) -> float:
    """Measure the processor time of a frame in Verilator, in milliseconds, and check every pixel of the last frame.

    Raises:
        AssertionError: a pixel of the last frame is wrong.
    """
    scene, command = scene_for(config), build_machine(config, build, processor=False)
    times = []
    for frames in (FEW, MANY):
        before = os.times()
        with Machine(command, config) as machine:
            machine.frame(writes=Walker(scene, config).load())
            shown_last = [machine.frame().picture for _ in range(frames)][-1]
        after = os.times()
        times.append(after.children_user + after.children_system - before.children_user - before.children_system)
    wrong = count_wrong(shown_last, shown(model_of(config).render(scene, config.screen_geometry), config))
    assert not wrong, f"{config.name}: {wrong} wrong pixels"
    return 1000 * (times[1] - times[0]) / (MANY - FEW)


def measure_scaling(output: Path, build: Path, console: Console) -> list[dict[str, Any]]:
    """Measure all designs of `SERIES`: cells, cycles and frame time, or the reason why a design is refused.

    Netlists go to `output`, and models below `build`.

    Raises:
        UserError: a tool is missing or failed.
    """
    rows, wanted = [], {}
    for row, config in _designs():
        rows.append(row)
        if isinstance(config, ConfigurationError):
            row["refused"] = str(config)
            continue
        wanted[config.name] = config
        row |= {
            "name": config.name, "units": config.units, "group_cycles": config.group_cycles,
            "frame_cycles": config.group_cycles * config.groups * config.screen_geometry.rows,
            "clock_mhz": config.screen_geometry.clock_hz / 1e6,
        }  # fmt: skip

    def count(config: Configuration) -> Area:
        return measure(config, FAMILY, output / config.name)

    areas = run_jobs("counting", count, list(wanted.values()), threads(JOBS), console)
    cells = {name: vars(area) for name, area in zip(wanted, areas, strict=True)}
    times = {
        name: frame_time(config, build)
        for name, config in track(wanted.items(), "simulating", console=console, transient=True)
    }
    for row in rows:
        if name := row.get("name"):
            row.update({kind: cells[name][kind] for kind in ("tables", "registers", "multipliers")})
            row["frame_ms"] = times[name]
    return rows


PANELS = (
    ("rectangles", "tables", "LUT4"),
    ("rectangles", "frame_ms", "frame time in Verilator, ms"),
    ("reflections", "tables", "LUT4"),
)


def draw_scaling(rows: Sequence[Mapping[str, Any]], measured: str, path: Path) -> None:
    """Plot growth with rectangles and reflections as SVG, a line per engine.

    Args:
        rows: the result of `measure_scaling`.
        measured: the date of the measurement, which the file states.
        path: the file, which is replaced.
    """
    with mpl.rc_context({"svg.hashsalt": "raycaster", "svg.fonttype": "none", "font.size": 9}):
        figure = Figure(figsize=(8, 8.4), layout="constrained")
        for axes, (option, count, title) in zip(figure.subplots(len(PANELS)), PANELS, strict=True):
            for name, engine in ENGINES.items():
                points = [
                    (row["value"], row[count])
                    for row in rows
                    if (row["engine"], row["option"]) == (name, option) and count in row
                ]
                axes.plot(*zip(*points, strict=True), color=engine.colour, marker=engine.marker, markersize=4)
                axes.annotate(name, points[-1], (8, 0), textcoords="offset points", color=engine.colour, va="center")
            axes.set(xlabel=option, ylabel=title, ylim=(0, None))
            axes.xaxis.get_major_locator().set_params(integer=True)
            axes.spines[["top", "right"]].set_visible(False)
            axes.grid(axis="y", alpha=0.3)
        figure.savefig(path, metadata={"Date": None, "Description": f"measured {measured}"})


def _series(option: str, kept: Outcome) -> str:
    """Return the table of the designs that differ in one option, for all engines."""
    lines = []
    for row in kept.figures["designs"]:
        if row["option"] != option:
            continue
        if "refused" in row:
            lines.append([f"`{row['engine']}`", row["value"], "refused", *6 * [""]])
            continue
        counts = [f"{row[name]:,}" for name in ("tables", "registers", "multipliers", "units", "frame_cycles")]
        clock, time = f"{row['clock_mhz']:g} MHz", f"{row['frame_ms']:.0f} ms"
        lines.append([f"`{row['engine']}`", row["value"], *counts, clock, time])
    headings = [
        "engine", option, "LUT4", "registers", "multipliers", "units", "cycles per frame, at most", "required clock",
        "frame time in Verilator",
    ]  # fmt: skip
    return table(headings, lines)


PUBLISHED = tuple(
    Published(f"scaling_{option}", ["scaling"], partial(_series, option)) for option in ("rectangles", "reflections")
)
