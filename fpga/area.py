# SPDX-License-Identifier: MIT
"""`raycaster area`: count a design's cells for three families of chips, with Yosys.

Totals are for the flattened design. Counts by module keep the hierarchy, which prevents some sharing between modules.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration, configure
from raycaster.convert.digest import verilog_digest
from raycaster.convert.take_home import TOP
from raycaster.engines import ENGINES
from raycaster.errors import UserError, not_installed
from raycaster.fit.fixing import add_fix_option, configuration_of
from raycaster.fpga import flows
from raycaster.fpga.cells import FAMILIES, PINS_TOP, Area, Family, measure, measure_modules, synthesise
from raycaster.fpga.multipliers import register_products
from raycaster.jobs import run_jobs, threads
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.outcomes import add_keep_option, keep
from raycaster.output import Console, Table
from raycaster.tools import find_program, prepare_wasm
from raycaster.waits import announce

ECP5 = flows.FLOWS["ecp5"]
NEXTPNR = ECP5.programs[0]
JOBS = 2


@dataclass(frozen=True)
class Chip:
    """Resources of a board's chip, from its maker's product tables."""

    board: str
    name: str
    family: str
    elements: int
    multipliers: int


CHIPS = (
    Chip("DE2", "EP2C35", "cycloneive", 33_216, 70),
    Chip("DE2-115", "EP4CE115", "cycloneive", 114_480, 532),
    Chip("DE1-SoC", "5CSEMA5", "cyclonev", 32_070, 261),
    Chip("DE10-Lite", "10M50", "cycloneive", 49_760, 288),
    Chip("ULX3S", "LFE5U-85F", "ecp5", 83_640, 156),
)
"""Chips of the boards. Multipliers of the Cyclones and the MAX 10 have 9 bits. Yosys lacks the Cyclone II and the
MAX 10; the Cyclone IV, which has the same logic elements, represents them."""


@dataclass(frozen=True)
class Model:
    """Estimate of a design's area from its number of units: a shared part, plus an equal part per unit."""

    shared: Area
    unit: Area

    @classmethod
    def of(cls, few: tuple[int, Area], many: tuple[int, Area]) -> Model:
        """Fit a model to two designs that differ only in their number of units; a unit is rounded to whole cells."""
        (low, less), (high, more) = few, many
        unit = Area(*(round(count / (high - low)) for count in vars(more - less).values()))
        return cls(less - unit * low, unit)

    def predict(self, units: int) -> Area:
        """Estimate the area of a design with this number of units."""
        return self.shared + self.unit * units

    def fitting(self, chip: Chip, columns: int) -> int:
        """Return the largest number of units that divides the columns and fits a chip; 0 if none fits.

        If it is not a power of two, the design takes slightly more than estimated: a ray's column is then a product.
        """
        fit = 0
        for units in range(1, columns + 1):
            area = self.predict(units)
            if columns % units == 0 and area.elements <= chip.elements and area.multipliers <= chip.multipliers:
                fit = units
        return fit


Counted = tuple[dict[str, Any], Configuration, str]
"""Labels of a row of figures, the design, and its module whose cells are counted."""


def unit_counts(config: Configuration) -> list[int]:
    """Return the numbers of units to synthesise: the given one and, if fewer are possible, up to three halvings."""
    if not config.facts.line_buffered:
        return [config.units]
    return [config.units >> times for times in range(4) if config.units % (1 << times) == 0]


def with_units(config: Configuration, units: int) -> Configuration:
    """Change a design's number of units, even if the design then misses the row budget."""
    return replace(config, units=units, allow_underrun=True)


def feature_designs() -> list[Counted]:
    """List each engine's designs without features, with each one alone, and with all.

    For the seed engine, the module is one ray unit, because a design has many.
    """
    designs = []
    for engine in ENGINES.values():
        top = "ray_unit" if engine.divides else TOP
        for chosen in ([], *([name] for name in engine.looks), engine.looks):
            options = dict.fromkeys(chosen, 1)
            labels = {"engine": engine.name, "module": top, "options": options}
            designs.append((labels, configure(engine=engine.name, **options), top))
    return designs


def measure_set(designs: Sequence[Counted], output: Path, console: Console) -> list[dict[str, Any]]:
    """Count the cells of a fixed set of designs for an ECP5.

    Raises:
        UserError: as `measure`.
    """
    tasks = {config.name: partial(measure, config, FAMILIES["ecp5"], top=top) for _, config, top in designs}
    results = _run(tasks, output, console)
    return [{**labels, **asdict(results[config.name])} for labels, config, _ in designs]


def _with_growth(features: Sequence[Mapping[str, Any]]) -> Iterator[tuple[Mapping[str, Any], str, float]]:
    """Yield each design's figures, its features as make variables, and how much larger they make it."""
    plain = {row["engine"]: row["tables"] for row in features if not row["options"]}
    for row in features:
        switches = " ".join(f"{name.upper()}=1" for name in row["options"])
        yield row, switches, row["tables"] / plain[row["engine"]] - 1


def show_features(features: Sequence[Mapping[str, Any]], console: Console) -> None:
    """Print the designs' cells, and how much larger each is than the design without features."""
    title = "ECP5, by feature; one ray unit for the seed engine"
    table = Table("design", "tables", "more", "registers", "multipliers", title=title)
    for row, switches, more in _with_growth(features):
        name = f"{row['engine']} {switches}"
        table.add_row(name, row["tables"], f"{more:+.1%}", row["registers"], row["multipliers"])
    console.print(table)


def route(config: Configuration, directory: Path, seed: int) -> dict[str, Any]:
    """Place and route the module alone, between registers, for the ECP5 of a ULX3S, on any pins.

    Args:
        config: configuration of the design.
        directory: output directory, which is replaced; keeps the tools' inputs and outputs.
        seed: seed of the placement.

    Returns:
        The required and the achieved clock, in MHz, and the used and available cells, by nextpnr's name.

    Raises:
        UserError: a program is missing, or reported an error.
    """
    synthesise(config, FAMILIES["ecp5"], directory, PINS_TOP)
    clock_mhz = config.screen_geometry.clock_hz / 1e6
    nextpnr = find_program(NEXTPNR)
    if nextpnr is None:
        raise UserError(not_installed(NEXTPNR, "fpga"))
    register_products(directory / "netlist.json")
    prepare_wasm(nextpnr)
    command = [nextpnr, "--85k", "--package", "CABGA381", "--speed", "6", "--json", "netlist.json"]
    command += ["--freq", f"{clock_mhz:g}", "--lpf-allow-unconstrained", "--seed", str(seed), *flows.ECP5_EFFORT]
    done = flows.place_and_route(command, ECP5.again, directory)
    if done.returncode:
        log = directory / "nextpnr.log"
        with log.open("a") as file:  # nextpnr may have failed before it created the log
            file.write(done.stdout + done.stderr)
        raise UserError(f"{NEXTPNR} failed; its log is {log}")
    report = json.loads((directory / "report.json").read_text())
    [clock] = report["fmax"].values()
    cells = {name: [of["used"], of["available"]] for name, of in report["utilization"].items() if of["used"]}
    return {"seed": seed, "clock_mhz": clock_mhz, "routed_mhz": round(clock["achieved"], 2), "cells": cells}


def show_routed(routed: Mapping[str, Any], console: Console) -> None:
    """Print the results of placing and routing."""
    cells = routed["cells"]["TRELLIS_COMB"]
    console.print(
        f"placed and routed for an LFE5U-85F-6, on any pins: {routed['routed_mhz']} MHz of {routed['clock_mhz']:g}, "
        f"{cells[0]:,} of {cells[1]:,} TRELLIS_COMB"
    )


def show_modules(family: Family, modules: Mapping[str, tuple[int, Area]], flat: Area, console: Console) -> None:
    """Print each module's cells, their sum, and the cells of the flattened design."""
    columns = "instances", "tables", "registers", family.element, "multipliers", "memories"
    table = Table("module", *columns, title=f"{family.title}, by module, one instance each")
    total = Area(0, 0, 0, 0, 0)
    for name, (instances, area) in modules.items():
        total += area * instances
        table.add_row(name, instances, *area.texts())
    table.add_section()
    table.add_row("all instances", "", *total.texts())
    table.add_row("flattened", "", *flat.texts())
    console.print(table)


def show_units(family: Family, areas: Mapping[int, Area], model: Model, console: Console) -> None:
    """Print the cells of designs with several numbers of units, and how well the model estimates them."""
    columns = "tables", "registers", family.element, "multipliers", "memories", "estimated", "error"
    table = Table("", *columns, title=f"{family.title}, by units")
    for name, area in (("shared", model.shared), ("one unit", model.unit)):
        table.add_row(name, *area.texts())
    table.add_section()
    for units, area in areas.items():
        estimated = model.predict(units).elements
        table.add_row(f"{units} units", *area.texts(), estimated, f"{estimated / area.elements - 1:+.1%}")
    console.print(table)


def show_chips(areas: Mapping[str, Area], models: Mapping[str, Model], config: Configuration, console: Console) -> None:
    """Print how much of each board's chip the design takes, and how many units fit."""
    table = Table(
        "board", "chip", "size", f"{config.units} units", "share", "multipliers", "most units", title="what fits"
    )
    for chip in CHIPS:
        if area := areas.get(chip.family):
            model = models.get(chip.family)
            share = f"{area.elements / chip.elements:.0%}"
            multipliers = f"{area.multipliers} of {chip.multipliers}"
            most = str(model.fitting(chip, config.screen_geometry.columns)) if model else ""
            table.add_row(chip.board, chip.name, chip.elements, area.elements, share, multipliers, most)
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("area", __doc__, "--engine exact --family ecp5")
    parser.add_argument("--family", help=f"family of chips: {', '.join(FAMILIES)} (default: all)")
    parser.add_argument("--route", action="store_true", help="also place and route for the ECP5 (takes minutes)")
    parser.add_argument("--route-only", action="store_true", help="only place and route")
    parser.add_argument("--seed", type=int, default=1, help="seed of the placement (default: %(default)s)")
    parser.add_argument(
        "--features", action="store_true", help="count the cells of each engine's features, such as TURN"
    )
    parser.add_argument("--output", type=Path, default=Path("build/area"), help="output directory (%(default)s)")
    add_scene_argument(parser, "scene to build in with --fix")
    add_fix_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog whose cells are counted."""
    if arguments.features:
        return verilog_digest(*(config for _, config, _ in feature_designs()))
    return verilog_digest(
        configuration_of(arguments.scene, given_options(arguments), arguments.fix, Console(quiet=True))
    )


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    if arguments.family and arguments.family not in FAMILIES:
        raise UserError(f"family: expected one of {', '.join(FAMILIES)}, got {arguments.family}")
    console = Console()
    if arguments.features:
        routing = arguments.route or arguments.route_only
        if any((arguments.scene, arguments.fix, arguments.family, routing, given_options(arguments))):
            raise UserError("features: counts a fixed set of designs, for the ECP5; leave everything else out")
        announce("area")
        rows = measure_set(feature_designs(), arguments.output, console)
        show_features(rows, console)
        keep(arguments, {"designs": rows}, verilog, "placing and routing")
        return
    config = configuration_of(arguments.scene, given_options(arguments), arguments.fix, console)
    # A directory per design and seed, so that two runs at a time do not replace each other's files.
    output = arguments.output / f"{config.name}-seed-{arguments.seed}"
    announce("area")
    if arguments.route_only:
        with console.waiting("placing and routing"):
            routed = route(config, output, arguments.seed)
        show_routed(routed, console)
        keep(arguments, {"configuration": config.name, **routed}, verilog, "a run on a chip")
        return
    families = [FAMILIES[arguments.family]] if arguments.family else list(FAMILIES.values())
    counts = unit_counts(config)
    # Long tasks come first, so that no long one is left to run alone at the end.
    tasks: dict[str, Callable[[Path], Any]] = {}
    if arguments.route:
        tasks["route"] = partial(route, config, seed=arguments.seed)
    for units, family in product(counts, families):
        tasks[f"{family.name}-{units}"] = partial(measure, with_units(config, units), family)
    for family in families:
        tasks[f"{family.name}-modules"] = partial(measure_modules, config, family)
    results = _run(tasks, output, console)

    models, published = {}, {"configuration": config.name, "families": {}}
    for family in families:
        areas = {units: results[f"{family.name}-{units}"] for units in counts}
        show_modules(family, results[f"{family.name}-modules"], areas[config.units], console)
        published["families"][family.name] = {"units": {units: asdict(area) for units, area in areas.items()}}
        if len(counts) > 1:
            # Fitted to the largest and the smallest design; those in between are estimated.
            many, *_, few = counts
            models[family.name] = model = Model.of((few, areas[few]), (many, areas[many]))
            show_units(family, areas, model, console)
            published["families"][family.name] |= {"shared": asdict(model.shared), "unit": asdict(model.unit)}
    whole = {family.name: results[f"{family.name}-{config.units}"] for family in families}
    show_chips(whole, models, config, console)
    if arguments.route:
        published["routed"] = results["route"]
        show_routed(published["routed"], console)
    (output / "area.json").write_text(json.dumps(published, indent=2) + "\n")
    keep(arguments, published, verilog, left_out="" if arguments.route else "placing and routing")


def _run(tasks: Mapping[str, Callable[[Path], Any]], output: Path, console: Console) -> dict[str, Any]:
    """Run tasks, some at a time, each with the output directory of its name; return the results by name."""
    output.mkdir(parents=True, exist_ok=True)
    results = run_jobs("counting", lambda name: tasks[name](output / name), list(tasks), threads(JOBS), console)
    return dict(zip(tasks, results, strict=True))
