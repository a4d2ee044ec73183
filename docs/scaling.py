# SPDX-License-Identifier: MIT
"""How cells, cycles and the simulation's time grow with rectangles, reflections, units and resolution, measured."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure
from rich.progress import track

from raycaster.configuration import MOST_RECTANGLES, MOST_REFLECTIONS, Configuration, ConfigurationError, configure
from raycaster.engines import ENGINES
from raycaster.fpga.area import FAMILIES, measure
from raycaster.golden import engines
from raycaster.golden.picture import count_wrong, shown
from raycaster.jobs import run_jobs
from raycaster.output import Console
from raycaster.play.machine import Machine, build_machine
from raycaster.play.walk import Walker
from raycaster.scene import Scene, load_scene, packaged_scenes

FAMILY = FAMILIES["ecp5"]
JOBS = 2
FEW, MANY = 2, 12
"""Frames of two runs, whose difference is the time that frames take."""


@dataclass(frozen=True)
class Series:
    """Designs that differ in one option; all else is as by default.

    Attributes:
        engine: of all of them.
        option: that differs, or several, as `resolution`.
        values: of it, each with the options that it stands for.
        simulated: whether a frame's time is measured too.
    """

    engine: str
    option: str
    values: Mapping[int | str, Mapping[str, Any]]
    simulated: bool = True


def _values(option: str, values: Sequence[int], **others: Any) -> dict[int | str, dict[str, Any]]:
    return {value: {option: value} | others for value in values}


RECTANGLES = (1, 4, 12, 24, MOST_RECTANGLES)
REFLECTIONS = tuple(range(MOST_REFLECTIONS + 1))
SERIES = (
    *(Series(engine, "rectangles", _values("rectangles", RECTANGLES)) for engine in ENGINES),
    *(Series(engine, "reflections", _values("reflections", REFLECTIONS)) for engine in ENGINES),
    Series("seed", "units", _values("units", (8, 16, 32), allow_underrun=True), simulated=False),
    Series("exact", "units", _values("units", (1, 4, 16, 32), allow_underrun=True), simulated=False),
    Series("exact", "resolution", {f"320x{rows}": {"rows": rows} for rows in (200, 240)}),
    Series(
        "beam",
        "resolution",
        {
            "320x240": {"scale": 1},
            "640x480": {"scale": 2},
            "1280x720": {"rows": 180, "scale": 3},
            "1920x1080": {"rows": 180, "scale": 6},
            "1920x1080, two pixels a clock": {"rows": 180, "scale": 6, "pixels": 2},
        },
    ),
)


def scene_for(config: Configuration) -> Scene:
    """As many rectangles as the design holds, of the packaged scenes one after the other."""
    scenes = [load_scene(path) for path in packaged_scenes(plain=True).values()]
    rectangles = [rectangle for scene in scenes for rectangle in scene.rect][: config.rectangles]
    return scenes[0].model_copy(update={"rect": tuple(rectangles), "reflections": config.reflections})


def frame_time(config: Configuration, build: Path) -> float:
    """Milliseconds of a processor that a frame takes in Verilator; the last frame is checked in every pixel.

    Raises:
        AssertionError: it was wrong.
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
    wrong = count_wrong(shown_last, shown(engines.render(config, scene, scene.reflections), config))
    assert not wrong, f"{config.name}: {wrong} wrong pixels"
    return 1000 * (times[1] - times[0]) / (MANY - FEW)


def measure_scaling(output: Path, build: Path, console: Console) -> list[dict[str, Any]]:
    """All designs of `SERIES`: what each takes and how long it takes, or why it is refused.

    Args:
        output: for the netlists.
        build: the directory that holds `model/`.
        console: for the progress bars.

    Raises:
        UserError: a tool is missing, or refuses something.
    """
    rows, wanted, timed = [], {}, {}
    for series in SERIES:
        for value, options in series.values.items():
            row = {"engine": series.engine, "option": series.option, "value": value}
            rows.append(row)
            try:
                config = configure(engine=series.engine, **options)
            except ConfigurationError as error:
                row["refused"] = str(error)
                continue
            wanted[config.name] = config
            if series.simulated:
                timed[config.name] = config
            row |= {
                "name": config.name, "units": config.units, "group_cycles": config.group_cycles,
                "frame_cycles": config.group_cycles * config.groups * config.screen_geometry.rows,
                "clock_mhz": config.screen_geometry.clock_hz / 1e6,
            }  # fmt: skip
    count = partial(_count, output=output)
    areas = run_jobs("counting", count, list(wanted.values()), partial(ThreadPoolExecutor, JOBS), console)
    cells = {name: vars(area) for name, area in zip(wanted, areas, strict=True)}
    times = {
        name: frame_time(config, build)
        for name, config in track(timed.items(), "simulating", console=console, transient=True)
    }
    for row in rows:
        if name := row.get("name"):
            row.update({count: cells[name][count] for count in ("tables", "registers", "multipliers")})
            row.update({"frame_ms": times[name]} if name in times else {})
    return rows


def _count(config: Configuration, output: Path) -> Any:
    return measure(config, FAMILY, output / config.name)


PANELS = (
    ("rectangles", "tables", "LUT4"),
    ("rectangles", "frame_ms", "a frame in Verilator, ms"),
    ("reflections", "tables", "LUT4"),
)
COLOURS = {"seed": "#b5651d", "exact": "#1f6f8b", "beam": "#6a4c93"}


def draw_scaling(rows: Sequence[Mapping[str, Any]], measured: str, path: Path) -> None:
    """Plot what grows with rectangles and reflections, a line an engine, as SVG.

    Args:
        rows: `measure_scaling`'s.
        measured: the day and commit, which the file tells.
        path: replaced.
    """
    settings = {"svg.hashsalt": "raycaster", "svg.fonttype": "none", "font.size": 9}
    with mpl.rc_context(settings):
        figure = Figure(figsize=(8, 8.4), layout="constrained")
        for axes, (option, count, title) in zip(figure.subplots(len(PANELS)), PANELS, strict=True):
            for engine, colour in COLOURS.items():
                points = [
                    (row["value"], row[count])
                    for row in rows
                    if (row["engine"], row["option"]) == (engine, option) and count in row
                ]
                axes.plot(*zip(*points, strict=True), color=colour, marker="o", markersize=4)
                axes.annotate(engine, points[-1], (8, 0), textcoords="offset points", color=colour, va="center")
            axes.set(xlabel=option, ylabel=title, ylim=(0, None))
            axes.xaxis.get_major_locator().set_params(integer=True)
            axes.spines[["top", "right"]].set_visible(False)
            axes.grid(axis="y", alpha=0.3)
        figure.savefig(path, metadata={"Date": None, "Description": f"measured {measured}"})
