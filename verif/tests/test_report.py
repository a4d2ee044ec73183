# SPDX-License-Identifier: MIT
"""The report: commands repeat their points, results are computed once, and pages are complete and true."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from html import unescape

import pytest
from conftest import ROOT, refused
from rich.console import Console

from raycaster.configuration import LOOKS, configure
from raycaster.fpga.cells import Area
from raycaster.fpga.fit import cycles_a_frame
from raycaster.golden import errors as golden_errors
from raycaster.golden.catalogue import catalogue
from raycaster.report import __main__ as report
from raycaster.report import designs, plots, points, stability
from raycaster.report.extent import extent
from raycaster.report.points import Point, Sweep, leaving_out, picture
from raycaster.scene import find_scene, load_scene

CORNERS = str(ROOT / "scenes" / "corners.toml")
TINY_PICTURE = picture("case:facing_x", 4, "nearest", 2, "tiny")
POINTS = {
    "picture": TINY_PICTURE,
    "world": picture("seed:5", 0, "nearest", 1),
    "cells": Point("cells", "ray_unit", configure(screen="tiny", units=1, rectangles=1, allow_underrun=True)),
    "left": Point("left", CORNERS, configure(engine="exact")),
    "time": Point("time", "scenes/boxes.toml", configure(culling=False, fraction_bits=8), 5),
}


@pytest.mark.parametrize("name", POINTS)
def test_a_command_names_its_point(name):
    program, *rest = POINTS[name].command.split()
    assert (program, rest[:2]) == (".venv/bin/python", ["-m", "raycaster.report.points"])
    assert points.parsed(rest[2:]) == POINTS[name]


def test_a_command_prints_its_result(tmp_path):
    command = [sys.executable, *TINY_PICTURE.command.split()[1:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.stderr, json.loads(done.stdout)) == ("", TINY_PICTURE.compute())


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ("picture case:nothing", "error: case:nothing: no such case in the catalogue; choose one of "),
        ("time nowhere.toml", "error: nowhere.toml: cannot be read"),
        ("picture seed:one", "error: seed:one: expected a whole number, 0 or more, as the seed"),
        ("report", "error: scenes: contains no scene files; run this in the project directory"),
    ],
)
def test_mistakes_get_one_line(tmp_path, words, complaint):
    main = report.main if words == "report" else points.main
    assert refused(main, *words.removeprefix("report").split(), cwd=tmp_path).startswith(complaint)


def sweep_of(directory, make_executor=lambda: ProcessPoolExecutor(2)) -> Sweep:
    return Sweep(directory / "store", make_executor, Console(quiet=True))


def test_designs_of_each_engine():
    """Designs with a line buffer meet the row budget; the beam engine has every scale and number of lanes."""
    seeds, exact = designs.seed_designs((0, 8), (20, 32)), designs.exact_designs((2, 4, 8))
    buffered = seeds + [one for one in exact if one.engine == "exact"]
    assert all(config.group_cycles * config.groups <= config.screen_geometry.row_cycles for config in buffered)
    assert {(one.fraction_bits, one.rounding) for one in seeds} == {(0, "truncate"), (0, "nearest"), (8, "nearest")}
    assert [config.units for config in buffered if config.engine == "exact"] == [4, 8]
    beams = [one for one in exact if one.engine == "beam"]
    assert all(points.predicted_cycles(config) == cycles_a_frame(config) for config in beams)
    lanes = {(1, 1), (2, 1), (2, 2), (4, 1), (4, 2), (6, 1), (6, 2)}
    assert {(config.scale, config.pixels) for config in beams} == lanes


def test_steps_of_leaving_out():
    """The scene fits every step's design; the last is the smallest, without rectangles that no ray sees."""
    scene, steps = load_scene(CORNERS), dict(leaving_out(CORNERS, "exact"))
    first, *_, last = steps.values()
    assert first.looks == LOOKS and first.reflections == 2 and first.rectangles == 12
    assert steps["light"].looks == () and steps["light"].fixed is None
    assert steps["rectangle registers"].fixed.camera is None
    assert steps["camera registers"].fixed.camera == scene.camera.position
    assert len(steps["camera registers"].fixed.rectangles) == len(scene.rect) > len(last.fixed.rectangles)


def test_a_bound_that_is_exceeded_is_a_red_line(tmp_path, monkeypatch):
    """The bound is computed as if truncation were rounding to nearest."""
    right = golden_errors._next_bound
    monkeypatch.setattr(golden_errors, "_next_bound", lambda *arguments: right(*arguments[:-1], 1))
    monkeypatch.setattr(stability, "FLIPPED", 1)
    cases = [case for case in catalogue() if case.name.startswith(("box", "facing", "grazing"))]
    sweep = sweep_of(tmp_path, lambda: ThreadPoolExecutor(1))
    chapter = stability.stability_chapter(replace(extent(quick=True), cases=cases), sweep)
    begins = "A bound is exceeded: box_20, F = 0, truncate. .venv/bin/python"
    assert any(alarm.startswith(begins) for alarm in chapter.alarms)
    assert not any("nearest" in alarm for alarm in chapter.alarms)


@pytest.mark.slow
def test_a_small_report(tmp_path, monkeypatch):
    """It has everything once, including simulations, and needs no other file; cell counts are invented."""

    def cells(config, family, directory, top):
        return Area(config.units * (600 + 20 * config.fraction_bits) + 3000, 0, 0, 2 * config.units, 0)

    def rows(name: str) -> list[dict[str, str]]:
        with (tmp_path / f"{name}.csv").open() as file:
            return list(csv.DictReader(file))

    monkeypatch.setattr(points, "measure", cells)
    monkeypatch.setattr(designs, "RUNS", 2)
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    for name in ("corners", "mirror_room"):
        (scenes / f"{name}.toml").write_text(find_scene(name).read_text())
    monkeypatch.chdir(tmp_path)
    what = replace(extent(quick=True), fractions=(0, 4), worlds=6, cases=catalogue()[::20], left=["corners"])
    write = partial(report.write_report, tmp_path, what, command_line="raycaster report")
    path, figures = write(sweep_of(tmp_path))
    html = unescape(path.read_text())
    assert 'class="alarm"' not in html and figures["alarms"] == 0
    assert html.count("<figure") == html.count("<svg ") == 10
    assert not re.search(r"(src|href)=\"(?!data:|#)", html)
    # The kept figures of the designs draw the same plot.
    again = designs.of_kept(json.loads(json.dumps(figures["designs"])))
    plots.save(designs.work_precision(again, "frame_ms"), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_text() == (tmp_path / "work_frame_ms.svg").read_text()
    keys = "scene", "F", "rounding", "reflections"
    [one] = [row for row in rows("pictures") if [row[key] for key in keys] == ["corners", "4", "nearest", "1"]]
    assert points.parsed(one["command"].split()[3:]) == picture("scenes/corners.toml", 4, "nearest", 1)
    assert [row["left out"] for row in rows("left")][::9] == ["", "hidden rectangles"]
    best = rows("designs")
    assert {one["design"].split()[0] for one in best} == {"seed", "exact,", "beam"}
    assert all(one["pixels unlike the model"] == "0" and "--runs 2" in one["command"] for one in best)
    assert "0 designs took more or fewer cycles than predicted, and 0 pixels differ from the golden model" in html
    # Nothing is computed twice: the pages are rebuilt from kept results.
    assert unescape(write(sweep_of(tmp_path, lambda: pytest.fail("not kept")))[0].read_text()) == html
