# SPDX-License-Identifier: MIT
"""`raycaster area`: count a design's cells for three families of chips, with Yosys, or route it alone.

Totals are for the flattened design. Counts by module keep the hierarchy, which prevents some sharing between modules.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from raycaster.configuration import FEATURES, MOST_RECTANGLES, MOST_REFLECTIONS, Configuration
from raycaster.convert.digest import verilog_digest
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser, add_configuration_options, add_scene_argument, given_options
from raycaster.errors import UserError, not_installed
from raycaster.fit.fixing import add_fix_option, configuration_of
from raycaster.fpga.bitstream import figures_of, read_report, show
from raycaster.fpga.board import OpenBoard, QuartusBoard, board_names, find_board
from raycaster.fpga.cells import FAMILIES, Area, Family, measure, measure_modules
from raycaster.fpga.flows import ECP5_EFFORT, FLOWS, SYSTEM_CLOCK, Clocks, place_and_route
from raycaster.fpga.netlist import write_netlist
from raycaster.output import Console, Table
from raycaster.rtl.engines import ENGINES, SPAN
from raycaster.runs.jobs import run_jobs, threads
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.runs.tools import find_program, prepare_wasm
from raycaster.runs.waits import announce

JOBS = 2
ROUTED, SPARE = "ulx3s", 1.03
"""Board with the chip on which `--route` places a module, and its clock relative to the one that the screen needs."""


_LOOKS = {"turn": 1, "materials": 1, "patterns": 1, "reflections": 2}
ROOM_DESIGNS: Mapping[str, Mapping[str, Any]] = {
    "plain": {"turn": 1},
    "looks": _LOOKS,
    "lit": {**_LOOKS, "light": 1},
    "full": {**dict.fromkeys(FEATURES, 1), "reflections": MOST_REFLECTIONS, "rectangles": MOST_RECTANGLES},
}
"""Options of designs with the span engine for rooms of any kind, from the smallest to the largest, by name."""


Counted = tuple[dict[str, Any], Configuration, str]
"""Labels of a row of figures, the design, and its module whose cells are counted."""


def feature_designs() -> list[Counted]:
    """List each engine's designs without features, with each one alone, and with all; then those of `ROOM_DESIGNS`.

    For the seed engine, the module is one ray unit, because a design has many.
    """
    designs = []
    for engine in ENGINES.values():
        top = "ray_unit" if engine.facts.divides else TOP
        chosen = [
            dict.fromkeys(names, 1)
            for names in ([], *([name] for name in engine.facts.features), engine.facts.features)
        ]
        rooms = ROOM_DESIGNS.values() if engine is SPAN else ()
        for options in (*chosen, *(dict(room) for room in rooms if room not in chosen)):
            labels = {"engine": engine.facts.name, "module": top, "options": options}
            designs.append((labels, configure(engine=engine.facts.name, **options), top))
    return designs


def measure_features(output: Path, console: Console) -> list[dict[str, Any]]:
    """Count the cells of `feature_designs` for an ECP5, and print how much larger each feature makes a design.

    Raises:
        UserError: as `measure`.
    """
    designs = feature_designs()
    tasks = {config.name: partial(measure, config, FAMILIES["ecp5"], top=top) for _, config, top in designs}
    results = _run(tasks, output, console)
    table = Table(
        "design", "tables", "more", "registers", "multipliers",
        title="ECP5, by feature; one ray unit for the seed engine",
    )  # fmt: skip
    rows, plain = [], 0
    for labels, config, _ in designs:
        area = results[config.name]
        features = [f"{name.upper()}={value}" for name, value in labels["options"].items()]
        plain = plain if features else area.tables
        more = f"{area.tables / plain - 1:+.1%}"
        table.add_row(" ".join([config.engine, *features]), area.tables, more, area.registers, area.multipliers)
        rows.append({**labels, **asdict(area)})
    console.print(table)
    return rows


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


def show_chips(areas: Mapping[str, Area], console: Console) -> None:
    """Print how much of each board's chip a design takes, given its cells by family."""
    table = Table("board", "chip", "size", "design", "share", "multipliers", title="what fits")
    quartus = [find_board(name, QuartusBoard) for name in board_names(QuartusBoard)]
    others = [find_board(name, OpenBoard) for name in board_names(OpenBoard)]
    for board, family in [*((one, one.counted_as) for one in quartus), *((one, one.flow) for one in others)]:
        if area := areas.get(family):
            share, multipliers = f"{area.elements / board.elements:.0%}", f"{area.multipliers} of {board.multipliers}"
            table.add_row(board.title, board.chip, board.elements, area.elements, share, multipliers)
    console.print(table)


def route(config: Configuration, seed: int, directory: Path, console: Console) -> dict[str, Any]:
    """Place and route the module alone, on an LFE5U-85F-6, with a pad at each port; print cells, clock and worst path.

    A missed clock is routed again within a time limit, as in `place_and_route`.

    Args:
        config: configuration of the design.
        seed: seed of the placement.
        directory: directory, which is replaced; keeps the netlist and nextpnr's reports.
        console: console for the tables.

    Returns:
        Figures as those of a bitstream, and the worst path's steps: the delay in ns, and the net or the cell.

    Raises:
        UserError: a program is missing, or failed.
    """
    board = find_board(ROUTED, OpenBoard)
    flow = FLOWS[board.flow]
    program = find_program(flow.programs[0])
    if program is None:
        raise UserError(not_installed(flow.programs[0], "fpga"))
    prepare_wasm(program)
    sources = [Path(path.name) for path in write_verilog(config, directory) if path.suffix == ".v"]
    netlist = write_netlist(flow, sources, TOP, board.multipliers, directory)
    aim = round(config.screen_geometry.clock_hz / 1e6 * SPARE, 2)
    # nextpnr finds no way to a clock buffer from some pads.
    [pin] = board.bits(board.clock).values()
    (directory / "clock.lpf").write_text(f'LOCATE COMP "{SYSTEM_CLOCK}" SITE "{pin}";\n')
    pads = ["--lpf", "clock.lpf", "--lpf-allow-unconstrained"]
    command = [flow.programs[0], *board.options, "--json", netlist.name, *pads, *ECP5_EFFORT]
    done = place_and_route([*command, "--freq", str(aim), "--seed", str(seed)], flow.again, directory)
    if done.returncode:
        raise UserError(f"{done.args[0]}: it failed; the log is {directory / 'nextpnr.log'}")
    report = directory / "report.json"
    outcome = read_report(flow, Clocks({}, {SYSTEM_CLOCK: aim}), report, {})
    show(board, outcome, console)
    paths = json.loads(report.read_text())["critical_paths"]
    [path] = [one["path"] for one in paths if "async" not in one["from"] + one["to"]]
    steps = [(round(step["delay"], 2), step.get("net", step["to"]["cell"])) for step in path]
    table = Table("ns", "through", title="worst path")
    for delay, name in steps:
        table.add_row(f"{delay:.2f}", name)
    console.print(table)
    return {**figures_of(board, config, seed, outcome), "title": "Module alone", "path": steps}


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("area", __doc__, "--engine exact --family ecp5")
    parser.add_argument("--family", help=f"family of chips: {', '.join(FAMILIES)} (default: all)")
    parser.add_argument(
        "--features", action="store_true", help="count the cells of each engine's features, such as TURN"
    )
    parser.add_argument("--route", action="store_true", help="place and route the module alone, on an ECP5-85F")
    parser.add_argument("--seed", type=int, help="seed of the placement, with --route (default: 1)")
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
    if arguments.route and arguments.family not in (None, "ecp5"):
        raise UserError("route: places a module on an ECP5 only; leave out --family")
    if arguments.seed is not None and not arguments.route:
        raise UserError("seed: chooses the placement, so it needs --route")
    console = Console()
    if arguments.features:
        if any((arguments.scene, arguments.fix, arguments.family, arguments.route, given_options(arguments))):
            raise UserError("features: counts a fixed set of designs, for the ECP5; leave everything else out")
        announce("area")
        figures = {"designs": measure_features(arguments.output, console)}
        keep(arguments, figures, verilog, left_out="placing and routing")
        return
    config = configuration_of(arguments.scene, given_options(arguments), arguments.fix, console)
    announce("area --route" if arguments.route else "area")
    if arguments.route:
        seed = 1 if arguments.seed is None else arguments.seed
        figures = route(config, seed, arguments.output / config.name, console)
        keep(arguments, figures, verilog, left_out="pins, and the paths to and from them")
        return
    families = [FAMILIES[arguments.family]] if arguments.family else list(FAMILIES.values())
    tasks: dict[str, Callable[[Path], Any]] = {}
    for family in families:
        tasks[family.name] = partial(measure, config, family)
        tasks[f"{family.name}-modules"] = partial(measure_modules, config, family)
    results = _run(tasks, arguments.output / config.name, console)
    for family in families:
        show_modules(family, results[f"{family.name}-modules"], results[family.name], console)
    whole = {family.name: results[family.name] for family in families}
    show_chips(whole, console)
    figures = {"configuration": config.name, "families": {name: asdict(area) for name, area in whole.items()}}
    keep(arguments, figures, verilog, left_out="placing and routing")


def _run(tasks: Mapping[str, Callable[[Path], Any]], output: Path, console: Console) -> dict[str, Any]:
    """Run tasks, some at a time, each with the output directory of its name; return the results by name."""
    output.mkdir(parents=True, exist_ok=True)
    results = run_jobs("counting", lambda name: tasks[name](output / name), list(tasks), threads(JOBS), console)
    return dict(zip(tasks, results, strict=True))
