# SPDX-License-Identifier: MIT
"""The report: its sweep loses nothing, its points say what they stand for, its pages have what they should."""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from html import unescape
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from distributed import Client
from rich.console import Console

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.fpga.area import Area
from raycaster.golden import errors as golden_errors
from raycaster.golden import exact, seed_engine
from raycaster.golden.catalogue import catalogue
from raycaster.golden.errors import compare
from raycaster.golden.random_world import random_camera, random_rectangles, random_slopes
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.jobs import executors
from raycaster.options import add_configuration_options, as_options, given_options
from raycaster.report import __main__ as report
from raycaster.report import conclusions, hardware
from raycaster.report.page import Section, write_html, write_markdown
from raycaster.report.points import CASE, UNITS, CellsPoint, HitsPoint, PicturePoint, View, command
from raycaster.report.sweep import Store, run
from raycaster.scene import find_scene
from raycaster.screens import SCREENS
from raycaster.verif.seeds import repeat, seed

ROOT = Path(__file__).parents[2]
QUIET = Console(quiet=True)
TINY = SCREENS["tiny", 48]
SLOPES = primary_slopes(TINY).reshape(-1, 3)


# Errors and bounds ----------------------------------------------------------------------------------------------------


def fraction_errors(table, camera, slope, reflections, fraction_bits, rounding):
    """Of one ray, for each depth at which it hits what the exact ray hits: errors and bounds, as fractions."""
    arguments = table, camera, (0, 0, 0), slope[None, :], reflections
    perfect = exact.trace(*arguments)
    rounded = seed_engine.trace(*arguments, fraction_bits=fraction_bits, rounding=rounding)
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
        found = compare(table, camera, (0, 0, 0), slope[None, :], 2, fraction_bits, rounding).depths
        for depth, error, bound in fraction_errors(table, camera, slope, 2, fraction_bits, rounding):
            assert found[depth].worst == pytest.approx(float(max(error)), rel=1e-12), repeat()
            assert found[depth].bound == pytest.approx(float(max(bound)), rel=1e-12), repeat()
            assert all(e <= b for e, b in zip(error, bound, strict=True)), repeat()
            compared += 1
    assert compared > 40, repeat()


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
@pytest.mark.parametrize("fraction_bits", [0, 1, 4, 8])
def test_no_bound_is_exceeded_in_random_scenes(fraction_bits, rounding):
    rng = np.random.default_rng(seed())
    hits = [0, 0, 0]
    for _ in range(30):
        table = random_rectangles(rng)
        camera = random_camera(rng, table)
        slopes = random_slopes(rng, 500)
        for depth, one in enumerate(compare(table, camera, (0, 0, 0), slopes, 2, fraction_bits, rounding).depths):
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
    """As if truncation were rounding to nearest."""
    view = View.of("case:facing_y_40")
    right = golden_errors._next_bound
    monkeypatch.setattr(golden_errors, "_next_bound", lambda *arguments: right(*arguments[:-1], 1))
    assert PicturePoint(view, 0, "truncate", 2, "tiny").compute()["depths"][0]["exceeded"] > 0


def test_a_hit_point_of_the_hardware_that_is_off_is_noticed(monkeypatch):
    config = configure(screen="tiny", units=16, reflections=2, divider_bits=3)
    point = HitsPoint(View.of("case:facing_y_40"), config)

    def golden_hits(_, scene, reflections, directory, *, off=0):
        traced = seed_engine.trace(
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


@pytest.mark.parametrize(
    "point",
    [
        PicturePoint(View.of("case:facing_x"), 4, "nearest", 2, "tiny"),
        PicturePoint(View.of(str(ROOT / "scenes" / "letterbox.toml")), 1, "truncate", 0),
        CellsPoint(SMALL, UNITS["seed"]),
    ],
    ids=["case", "scene", "cells"],
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
        (("points", "picture", "case:nothing"), "error: case:nothing: the catalogue has no such case; it has "),
        (("points", "time", "nowhere.toml"), "error: nowhere.toml: cannot be read"),
        (("points", "cells", "ray_unit", "--units", "7"), "error: units: 7 does not divide"),
        (("report",), "error: scenes: has no scene files; run this in the project's directory"),
        (("report", "--scheduler", "nowhere"), "error: scheduler: no Dask scheduler answers at nowhere"),
        (("report", "--scheduler", "tcp://127.0.0.1:1"), "error: scheduler: no Dask scheduler answers at tcp://127"),
    ],
)
def test_what_is_wrong_gets_one_line(tmp_path, words, complaint):
    module, *rest = words
    program = "raycaster.report.points" if module == "points" else "raycaster.cli"
    call = [sys.executable, "-m", program, *(rest if module == "points" else words)]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(complaint)
    assert done.stderr.count("\n") == 1


# Sweeps ---------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Task:
    """A point that leaves a mark each time it is computed, and kills its worker the first time if it is told to."""

    directory: str
    number: int
    deadly: bool = False
    seconds: float = 0.0
    scene: ClassVar[None] = None
    folders: ClassVar[tuple[str, ...]] = ()

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
    """Until a process that runs has done something, a minute at most."""
    deadline = time.monotonic() + 60
    while not happened():
        assert process.poll() is None, "it has ended"
        assert time.monotonic() < deadline, "it has not happened in a minute"
        time.sleep(0.01)


def sweep_slowly(directory: str) -> None:
    """What `test_a_sweep_killed_half_way_loses_nothing` runs and kills."""
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


def test_what_a_result_depends_on_makes_it_stale(tmp_path, monkeypatch):
    store = Store(tmp_path)
    point = PicturePoint(View.of("case:facing_x"), 4, "nearest", 2, "tiny")
    store.keep(point, {"wrong": 1})
    assert store.find(point) == {"wrong": 1}
    assert store.find(replace(point, fraction_bits=3)) is None
    moved = View("case:facing_x", point.scene.model_copy(update={"background": (1, 2, 3)}))
    assert store.find(replace(point, view=moved)) is None
    monkeypatch.setattr("raycaster.report.points._sources_digest", lambda folder: b"edited")
    assert store.find(point) is None


def test_a_damaged_result_is_none(tmp_path):
    store = Store(tmp_path)
    store.keep(Task("", 1), {"square": 1})
    [path] = tmp_path.iterdir()
    path.write_text(path.read_text()[:20])
    assert store.find(Task("", 1)) is None


@contextmanager
def cluster(directory: Path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """A Dask scheduler and two workers, as anyone would start them; yields the address and the workers."""
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


def test_the_frontier():
    config = configure()
    best, dear = hardware.Candidate(config, 0.01, 100, 64), hardware.Candidate(config, 0.01, 101, 64)
    exacter = hardware.Candidate(config, 0.001, 200, 64)
    slower = hardware.Candidate(replace(config, rectangles=13), 0.0005, 200, 64)
    slowest = hardware.Candidate(replace(config, rectangles=14), 0.0005, 200, 64)
    assert hardware.frontier([dear, slowest, slower, exacter, best, best]) == [exacter, best, best, slower]


def test_designs_meet_the_row_budget():
    found = hardware.seed_designs((0, 8), (20, 32), "vga") + hardware.exact_designs((2, 4, 8), "vga")
    assert all(config.group_cycles * config.groups <= config.screen_geometry.row_cycles for config in found)
    assert not any((config.units, config.divider_bits) == (20, 1) for config in found)
    assert any(config.fraction_bits == 8 for config in found)
    assert [config.units for config in found if config.engine == "exact"] == [4, 8]


def test_pages_need_nothing_else(tmp_path):
    (tmp_path / "plot.png").write_bytes(b"not looked at")
    sections = [
        Section("One <title>", "text", ["a & b"], "plot.png"),
        Section("Two", columns=("name", "count"), rows=[["<x>", 12345], ["y", None]]),
    ]
    html = write_html("what it is", sections, tmp_path).read_text()
    assert "data:image/png;base64,bm90IGxvb2tlZCBhdA==" in html
    assert not re.search(r"(src|href)=\"(?!data:)", html)
    assert "One &lt;title&gt;" in html and "a &amp; b" in html and "&lt;x&gt;" in html and "12,345" in html
    text = write_markdown("what it is", sections, tmp_path).read_text()
    assert "![One <title>](plot.png)" in text and "| <x> | 12,345 |" in text and "| y |  |" in text


def test_conclusions_are_drawn_from_the_numbers():
    view = View.of("case:facing_x")

    def results(*shares: float) -> dict[PicturePoint, dict]:
        return {
            PicturePoint(view, f, rounding, 1): {"wrong_share": share, "wrong": int(1e5 * share)}
            for f, share in enumerate(shares)
            for rounding in ("truncate", "nearest")
        }

    [enough] = conclusions.enough_fraction(results(0.1, 0.0005, 0.002, 0.0001))
    assert enough == (
        "facing_x: at most 0.1% of the pixels are wrong from F = 3 when truncated, from F = 3 when rounded to nearest."
    )
    [never] = conclusions.enough_fraction(results(0.1, 0.1))
    assert "no F up to 1 when truncated" in never
    numbers = results(0.1)
    [same] = conclusions.where_roundings_differ(numbers, 0)
    assert same.startswith("At F = 0 neither rounding")
    numbers[PicturePoint(view, 0, "nearest", 1)]["wrong"] = 7
    [differ] = conclusions.where_roundings_differ(numbers, 0)
    assert differ.endswith("wrong when truncated as when rounded to nearest in: facing_x (10,000 against 7).")


def test_a_small_report(tmp_path, monkeypatch):
    """Everything in it once, simulations included; cells are invented."""

    def cells(config, family, directory, top):
        alone = top in UNITS.values()
        units = 1 if alone else config.units
        return Area(units * (600 + 20 * config.fraction_bits) + (0 if alone else 3000), 0, 0, 2 * units, 0)

    monkeypatch.setattr("raycaster.report.points.measure", cells)
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    for name in ("mirror_room", "matte"):
        (scenes / f"{name}.toml").write_text(find_scene(name).read_text())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(report, "GROWING", ("facing_x",))
    cases = catalogue()[::20]
    probed = configure(screen="tiny", units=16, reflections=2, divider_bits=3)
    # Its rays hit at every depth.
    [facing] = [case for case in catalogue() if case.name == "facing_y_40"]
    extent = report.Extent(
        (0, 4), (0, 1), (0,), (16,), (4,), cases, (0,), "tiny", [facing], [probed], "tiny", 1, ["exact"]
    )
    output = tmp_path / "report"
    output.mkdir()
    sweeper = report.Sweeper(Store(output / "points"), lambda: ProcessPoolExecutor(2), QUIET)
    page = report.write_report(output, extent, sweeper)
    html = unescape(page.read_text())
    assert html.count("data:image/png;base64,") == html.count("<img") == 7
    for name in (
        "index.html",
        "report.md",
        "points.csv",
        "frontier.csv",
        "culling.csv",
        "catalogue.csv",
        "catalogue_hardware.csv",
    ):
        assert (output / name).stat().st_size > 0
    assert "0 took other cycles than foretold, 0 pixels were not golden's" in html
    assert "a shared part of 3,000 LUT4" in html and "(+0.0%)" in html
    with (output / "points.csv").open() as file:
        points = list(csv.DictReader(file))
    assert len(points) == 2 * 2 * 2 * 2 + len(cases) * 2
    [one] = [
        p for p in points if (p["scene"], p["F"], p["rounding"], p["reflections"]) == ("matte", "4", "nearest", "0")
    ]
    assert one["command"].endswith(
        "points picture scenes/matte.toml --fraction-bits 4 --rounding nearest --reflections 0 --screen vga"
    )
    with (output / "frontier.csv").open() as file:
        [first, *others] = csv.DictReader(file)
    [exact_row] = [row for row in (first, *others) if row["engine"] == "exact"]
    assert (exact_row["wrong, mean share"], exact_row["on the frontier of all"]) == ("0.0", "yes")
    assert first["cycles a group: a pixel and unit"] == first["cycles a group, foretold"]
    assert "raycaster.report.points time scenes/mirror_room.toml" in first["command"]
    with (output / "culling.csv").open() as file:
        for row in csv.DictReader(file):
            assert 0 < int(row["frame cycles with"]) < int(row["frame cycles without"])
            assert row["wrong against golden"] == "0"
            assert row["command"].endswith("--culling 1")
    with (output / "catalogue_hardware.csv").open() as file:
        [seen] = csv.DictReader(file)
    assert (seen["hit points not golden's"], seen["over the bound"]) == ("0", "0")
    assert float(seen["worst, depth 2"]) > 0
    # Nothing is found out twice: the pages are made anew from what is stored.
    sweeper = report.Sweeper(Store(output / "points"), lambda: pytest.fail("not stored"), QUIET)
    assert unescape(report.write_report(output, extent, sweeper).read_text()) == html
