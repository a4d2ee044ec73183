# SPDX-License-Identifier: MIT
"""`python -m raycaster.report.points`: one point of the report again, as JSON."""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

from raycaster.configuration import Configuration, configure
from raycaster.convert.take_home import TOP
from raycaster.errors import UserError
from raycaster.fpga.area import FAMILIES, measure
from raycaster.golden import exact, seed_engine
from raycaster.golden.catalogue import catalogue
from raycaster.golden.errors import compare, depth_errors
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import Rounding
from raycaster.golden.world import Rectangles
from raycaster.options import add_configuration_options, as_options, given_options, run_command
from raycaster.scene import Scene, dump_scene, load_scene
from raycaster.screens import SCREENS, Screen
from raycaster.sim.job import Job
from raycaster.sim.simulator import build_model, run_bench
from raycaster.verif.hit_points import build_probed_model, hit_points

CASE = "case:"
"""Before the name of a scene of the catalogue, where a scene file's path would stand."""

FAMILY = FAMILIES["ecp5"]
UNITS = {"seed": "ray_unit", "exact": "exact_unit"}
"""By engine, the module of which there are as many as the configuration's units."""

ROOT = Path(__file__).parent.parent


class Point(Protocol):
    """Something to find out that takes a while. Points travel to other processes, and carry all that they need."""

    folders: ClassVar[Sequence[str]]
    """Whose sources a result depends on."""

    @property
    def arguments(self) -> str:
        """What this module's command repeats it with."""

    @property
    def scene(self) -> Scene | None:
        """That it looks at, if it does."""

    def compute(self) -> dict[str, Any]:
        """The result, of values that JSON has."""


@dataclass(frozen=True)
class View:
    """A scene, by path or by `CASE` and a name."""

    source: str
    scene: Scene = field(compare=False, repr=False)

    @classmethod
    def of(cls, source: str) -> View:
        """Find the scene.

        Raises:
            UserError: it is a file that cannot be read or is no scene, or the catalogue has no such case.
        """
        if not source.startswith(CASE):
            return cls(source, load_scene(source))
        if source.removeprefix(CASE) not in _cases():
            raise UserError(f"{source}: the catalogue has no such case; it has {', '.join(_cases())}")
        return cls(source, _cases()[source.removeprefix(CASE)])

    @property
    def name(self) -> str:
        """For people."""
        return self.source.removeprefix(CASE) if self.source.startswith(CASE) else Path(self.source).stem


@cache
def _cases() -> dict[str, Scene]:
    return {case.name: case.scene for case in catalogue()}


@dataclass(frozen=True)
class PicturePoint:
    """A picture of the golden model under one arithmetic, against the exact one: `raycaster.golden.errors.Errors`."""

    view: View
    fraction_bits: int
    rounding: Rounding
    reflections: int
    screen: str = "vga"
    folders: ClassVar[Sequence[str]] = ("golden", "raycaster")

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
        """An infinite ratio is None."""
        errors = compare(
            Rectangles.of_scene(self.scene), self.scene.camera.position, self.scene.background,
            primary_slopes(_screen(self.screen, self.scene.rows)).reshape(-1, 3),
            self.reflections, self.fraction_bits, self.rounding,
        )  # fmt: skip
        result = asdict(errors) | {"depths": [asdict(depth) for depth in errors.depths]}
        result["psnr"] = errors.psnr if math.isfinite(errors.psnr) else None
        result["wrong_share"] = errors.wrong / errors.pixels
        return result


def _screen(name: str, rows: int) -> Screen:
    """What a scene is looked at through: scenes of 180 rows are made for another engine, and get 240."""
    return SCREENS["tiny", 48] if name == "tiny" else SCREENS["vga", rows if ("vga", rows) in SCREENS else 240]


@dataclass(frozen=True)
class CellsPoint:
    """LUT4 and multipliers of an ECP5 that a design or one module of it takes, by itself."""

    config: Configuration
    top: str = TOP
    scene: ClassVar[None] = None
    folders: ClassVar[Sequence[str]] = ("rtl", "raycaster", "fpga")

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return " ".join(["cells", self.top, *as_options(self.config)])

    def compute(self) -> dict[str, Any]:
        """The counts."""
        with tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
            area = measure(self.config, FAMILY, Path(scratch) / "area", self.top)
        return {"cells": area.tables, "multipliers": area.multipliers}


@dataclass(frozen=True)
class TimePoint:
    """What a design's own counters say of a scene in simulation, and the pixels that are not golden's."""

    view: View
    config: Configuration
    folders: ClassVar[Sequence[str]] = ("rtl", "raycaster", "golden", "verif")

    @property
    def arguments(self) -> str:
        """As the command wants them."""
        return " ".join(["time", self.view.source, *as_options(self.config)])

    @property
    def scene(self) -> Scene:
        """That is shown."""
        return self.view.scene

    def compute(self) -> dict[str, Any]:
        """Of the slowest group and row, and of the frame."""
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
        }


@dataclass(frozen=True)
class HitsPoint:
    """Where the rays of a scene hit in the converted Verilog: the errors, and the hit points that are not golden's."""

    view: View
    config: Configuration
    folders: ClassVar[Sequence[str]] = ("rtl", "raycaster", "golden", "verif")

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
        perfect = exact.trace(rectangles, camera, background, slopes, config.reflections)
        golden = seed_engine.trace(
            rectangles, camera, background, slopes, config.reflections,
            fraction_bits=config.fraction_bits, rounding=config.rounding,
        )  # fmt: skip
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
    """Of all that a point's result depends on: a stored result with another one is not looked at."""
    digest = hashlib.sha256(point.arguments.encode())
    digest.update(dump_scene(point.scene).encode() if point.scene else b"")
    for folder in point.folders:
        digest.update(_sources_digest(folder))
    return digest.hexdigest()


@cache
def _sources_digest(folder: str) -> bytes:
    digest = hashlib.sha256()
    for path in sorted((ROOT / folder).iterdir()):
        if path.suffix in (".py", ".rdl", ".v"):
            digest.update(path.read_bytes())
    return digest.digest()


def _parse(arguments: argparse.Namespace, options: Mapping[str, Any]) -> Point:
    config = configure(**{"allow_underrun": True, **options} if arguments.kind == "picture" else options)
    if arguments.kind == "cells":
        return CellsPoint(config, arguments.what)
    view = View.of(arguments.what)
    if arguments.kind == "picture":
        return PicturePoint(view, config.fraction_bits, config.rounding, config.reflections, config.screen)
    return (TimePoint if arguments.kind == "time" else HitsPoint)(view, config)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m raycaster.report.points", description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=("picture", "cells", "time", "hits"))
    parser.add_argument("what", help=f"a scene file, {CASE}NAME of the catalogue, or, of cells, a module")
    add_configuration_options(parser)
    arguments = parser.parse_args()
    print(json.dumps(_parse(arguments, given_options(arguments)).compute(), indent=1))


if __name__ == "__main__":
    run_command(main)
