# SPDX-License-Identifier: MIT
"""Show scenes on the converted hardware, and compare every pixel with the golden model: `make sim`."""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration
from raycaster.convert.digest import verilog_digest
from raycaster.design.for_scene import Design, left_out, packaged_for
from raycaster.design.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    add_scene_argument,
    command_line,
    given_options,
)
from raycaster.errors import UserError
from raycaster.fit.fixing import add_fix_option, design_of
from raycaster.golden import frames
from raycaster.output import MARK, Console, Table, check_replaceable, printable, put, remove, replaced
from raycaster.rtl.engines import ENGINES, SEED
from raycaster.runs.jobs import processes
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.runs.waits import building
from raycaster.scene import Scene, load_scene, packaged_scenes
from raycaster.sim.contact_sheet import write_contact_sheet
from raycaster.sim.job import Job
from raycaster.sim.netlist import LIBRARIES, Netlist, find_yosys, synthesise
from raycaster.sim.simulator import (
    SIMULATORS,
    Model,
    SimulationError,
    add_simulator_option,
    build_model,
    convert,
    find_tool,
    run_bench,
    when_made,
)

GATES_OPTIONS: Mapping[str, Any] = {"screen": "tiny", "units": 16, "reflections": 2}
"""A netlist's default options: the fewest units, if a row is buffered, with which one design shows all packaged scenes
in time."""

PICTURED = ("reflections", "rectangles", "fraction_bits", "rounding", "colour_bits", "allow_underrun", "fix", "cells")
"""Further options that are in the name of a directory, as they may change the pictures, or say how they were made."""

SHEET = "scenes.png"
SHEET_COLUMNS = 5
RESULT = "result.json"
"""File that a bench writes last, when it has a picture."""

NEWLINE = "\n"
COLUMNS: Mapping[str, str] = {
    "engine": "",
    "wrong": "pixels that differ from the golden model",
    "vs\nexact": "pixels that differ from the exact picture, for the engine that rounds",
    "frame": "clock cycles to render it",
    "row\nused": "share of the available clock cycles that the slowest row took",
    "group\nused": "the same for the slowest group of columns",
    "alone\nHz": "frames per second of the renderer by itself",
    "shown\nHz": "frames per second on the monitor, which shows a frame again for each refresh that the next one takes",
    "time\ns": "seconds in the simulator",
}
"""Headings of the table, and what they mean."""

POLL_SECONDS = 0.1


@dataclass(frozen=True)
class Outcome:
    """Outcome of a run: results as in `result.json`, and the failure if there was one."""

    run: Design
    result: dict[str, Any] | None
    failure: str = ""
    waves: Path | None = None


def plan_runs(
    paths: Iterable[Path],
    options: Mapping[str, Any],
    defaults: Mapping[str, Any],
    scope: str | None = None,
    console: Console | None = None,
) -> list[Design]:
    """Plan all runs before anything is built, so that a mistake costs no time.

    Args:
        paths: the scene files.
        options: the options given by the user.
        defaults: the hardware's options if the user gives none.
        scope: the part of each scene to build in; see `raycaster.fit.fixing`.
        console: where to show what that leaves out of the hardware.

    Raises:
        UserError: see `design_of`; or two scenes would write into one directory.
    """
    if scope:
        # The scene determines units and reflections then.
        defaults = {name: value for name, value in defaults.items() if name == "screen"}
    paths = list(paths)
    shared = {} if scope else _shared({path: load_scene(path) for path in paths})
    runs = [
        design_of(path, options, scope, console or Console(quiet=True), **(shared.get(path, {}) | dict(defaults)))
        for path in paths
    ]
    seen: dict[str, Path] = {}
    for run in runs:
        if (other := seen.setdefault(run.name, run.path)) != run.path:
            raise UserError(f"{run.path}: has the same file name as {other}, so their pictures would share a directory")
    return runs


def _shared(scenes: Mapping[Path, Scene]) -> dict[Path, dict[str, Any]]:
    """Choose hardware for the scenes that need extra features, by path.

    Such scenes that the default engine can show share one design, and the others share another: with a design per
    scene, most of the time would go into building.
    """
    groups: dict[bool, dict[Path, Scene]] = defaultdict(dict)
    for path, scene in scenes.items():
        if scene.lacks(()):
            groups[bool(scene.lacks(SEED.facts.features))][path] = scene
    found: dict[Path, dict[str, Any]] = {}
    for group in groups.values():
        if len(group) > 1:
            needed = {look: True for scene in group.values() for look in scene.lacks(())}
            most = max(scene.reflections for scene in group.values())
            found |= {path: {"reflections": most, **needed} for path in group}
    return found


def simulate(run: Design, model: Model, sim: Path, progress: Path) -> Outcome:
    """Run one scene; its directory in `sim` appears when it is complete.

    If the simulation ends without a picture, as after an interruption, the last run's picture stays, and the log is in
    a directory next to it.

    Args:
        run: the scene.
        model: a model of its configuration.
        sim: the directory of all outputs.
        progress: the file in which the simulation counts visible lines.
    """
    target, failed = sim / run.name, sim / f"{run.name}-failed"
    failure, waves = "", None
    try:
        with replaced(target) as partial:
            job = Job(
                configuration=run.configuration,
                scene=str(run.path.resolve()),
                output=str(partial.resolve()),
                reflections=run.reflections,
                progress=str(progress.resolve()),
            )
            try:
                waves = run_bench(model, "raycaster.sim.frame_bench", job, partial)
            except SimulationError as error:
                is_whole = (partial / RESULT).exists()
                failure = str(error).replace(str(partial.resolve()), str(target if is_whole else failed))
                if not is_whole:
                    put(partial, failed)
                    raise SimulationError(failure) from None
    except SimulationError:
        return Outcome(run, None, failure)
    if failure and (target / "diff.png").exists():
        failure += f"; the difference is {target / 'diff.png'}"
    return Outcome(run, json.loads((target / RESULT).read_text()), failure, target / waves.name if waves else None)


def output_directory(build: Path, engines: Collection[str], options: Mapping[str, Any], kind: str = "sim") -> Path:
    """Return the directory for the pictures of a run: another one for each engine, and for options that change them.

    Args:
        build: the directory of all output.
        engines: engines of the run's designs; several have a directory without an engine's name.
        options: options of the configuration that were given.
        kind: beginning of its name.
    """
    apart = [*engines] if len({*engines}) == 1 else []
    apart += [str(options[name]) for name in ("screen", "rows", "scale") if name in options]
    apart += [f"{name}-{options[name]}".replace("_", "-") for name in PICTURED if name in options]
    return build / "-".join([kind, *apart])


def tidy(directory: Path, outcomes: Sequence[Outcome]) -> None:
    """Remove pictures that look as if this run had made them: an older sheet and, next to a new sheet, older scenes.

    A run of one scene makes no sheet, and leaves the other scenes as they are.
    """
    (directory / SHEET).unlink(missing_ok=True)
    if len(outcomes) > 1:
        names = {outcome.run.name for outcome in outcomes}
        for other in directory.iterdir() if directory.exists() else ():
            if other.name.removesuffix("-failed") not in names and (other / MARK).exists():
                remove(other)
    for outcome in outcomes:
        if outcome.result is not None:
            remove(directory / f"{outcome.run.name}-failed")


def configurations(runs: list[Design]) -> list[Configuration]:
    """List the designs of these runs, each once."""
    return list({run.configuration.name: run.configuration for run in runs}.values())


def synthesise_all(runs: list[Design], build: Path, family: str, console: Console) -> dict[str, Netlist]:
    """Synthesise a netlist for each configuration, and return them by the configuration's name."""
    netlists: dict[str, Netlist] = {}
    for configuration in configurations(runs):
        name = configuration.name
        with console.waiting(f"synthesising {name}"):
            started = time.perf_counter()
            netlist = synthesise(convert(configuration, build), build / "model" / name, family=family)
        took = f"synthesised in {time.perf_counter() - started:.1f} s" if netlist.fresh else "was synthesised before"
        console.print(f"{name} {took}")
        netlists[name] = netlist
    return netlists


def build_models(
    runs: list[Design],
    simulator: str,
    waves: bool,
    build: Path,
    netlists: Mapping[str, Netlist],
    jobs: int,
    console: Console,
) -> dict[str, Model]:
    """Build a model for each configuration, of its netlist if it has one; return them by the configuration's name."""
    models: dict[str, Model] = {}
    wanted = configurations(runs)
    with tempfile.TemporaryDirectory() as directory, processes(min(jobs, len(wanted)))() as pool:
        marks = [Path(directory) / one.name for one in wanted]
        built = [
            pool.submit(_build, simulator, waves, build, one, netlists.get(one.name), mark)
            for one, mark in zip(wanted, marks, strict=True)
        ]
        for configuration, future, mark in zip(wanted, built, marks, strict=True):
            while not mark.exists() and not future.done():
                wait([future], timeout=POLL_SECONDS)
            with ExitStack() as shown:
                if mark.exists():
                    what = f"building {configuration.name} with {simulator}"
                    shown.enter_context(console.waiting(what, building(configuration.facts)))
                model, seconds = future.result()
            took = f"built in {seconds:.1f} s" if model.fresh else "was built before"
            console.print(f"{configuration.name} ({simulator}) {took}")
            models[configuration.name] = model
    return models


def _build(
    simulator: str, waves: bool, build: Path, configuration: Configuration, netlist: Netlist | None, mark: Path
) -> tuple[Model, float]:
    """Build a model, and return it with the seconds that it took; the mark is a file that says that it begins."""
    started = time.perf_counter()
    # A netlist does not keep the names that the bench reads.
    given = {"verilog": netlist.files, "defines": {"NETLIST": 1}} if netlist else {}
    with when_made(mark.touch):
        model = build_model(configuration, simulator, waves=waves, build=build, **given)
    return model, time.perf_counter() - started


def run_all(runs: list[Design], models: dict[str, Model], sim: Path, jobs: int, console: Console) -> list[Outcome]:
    """Run scenes in parallel, and show the progress of each."""
    name, lines = TextColumn("{task.description}", markup=False), TextColumn("{task.completed}/{task.total} lines")
    with (
        tempfile.TemporaryDirectory() as directory,
        ThreadPoolExecutor(jobs) as pool,
        Progress(name, BarColumn(), lines, TimeElapsedColumn(), console=console, transient=True) as bars,
    ):
        futures: dict[Future[Outcome], tuple[Any, Path]] = {}
        for run in runs:
            progress = Path(directory) / run.name
            bar = bars.add_task(printable(run.path.stem), total=run.configuration.screen_geometry.vertical.visible)
            futures[pool.submit(simulate, run, models[run.configuration.name], sim, progress)] = (bar, progress)
        pending = set(futures)
        try:
            while pending:
                _, pending = wait(pending, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
                for bar, progress in futures.values():
                    text = progress.read_text() if progress.exists() else ""
                    if text:
                        bars.update(bar, completed=int(text))
        except BaseException:
            pool.shutdown(cancel_futures=True)  # an interruption ends only the running scenes
            raise
        return [future.result() for future in futures]


def show_cells(netlists: Mapping[str, Netlist], console: Console) -> None:
    """Print a table of the netlists' cells, one line per netlist."""
    used = sorted({cell for netlist in netlists.values() for cell in netlist.cells})
    table = Table("netlist", *(cell.replace("_", "\n") for cell in used))
    for name, netlist in netlists.items():
        table.add_row(name, *(netlist.cells.get(cell, 0) for cell in used))
    console.print(table)


def show(outcomes: list[Outcome], console: Console, title: str | None = None) -> None:
    """Print a table with one line per scene, then the waveforms and the failures."""
    cells = [_cells(outcome) for outcome in outcomes]
    # Without columns that would be empty, and narrow enough for a terminal of 80 columns.
    used = [number for number in range(len(COLUMNS)) if any(str(row[number]) for row in cells)]
    columns = [list(COLUMNS.items())[number] for number in used]
    table = Table("scene", *(heading for heading, _ in columns), title=title, texts=("engine",), padding=0)
    for outcome, row in zip(outcomes, cells, strict=True):
        table.add_row(outcome.run.path.stem, *(row[number] for number in used))
    console.print(table)
    meanings = (f"{heading.replace(NEWLINE, ' ')}: {meaning}." for heading, meaning in columns if meaning)
    console.print(" ".join(meanings), style="dim")
    for outcome in outcomes:
        if outcome.waves:
            console.print(f"{outcome.run.path.stem}: waveforms are in {outcome.waves}", soft_wrap=True)
    for outcome in outcomes:
        if outcome.failure:
            console.print(f"{outcome.run.path.stem}: {outcome.failure}", style="red", soft_wrap=True)


def write_sheet(outcomes: list[Outcome], path: Path) -> None:
    """Write one picture of all frames, with their names."""
    names = [outcome.run.name for outcome in outcomes if outcome.result is not None]
    if names:
        frames = [path.parent / name / "frame.png" for name in names]
        write_contact_sheet(frames, path, SHEET_COLUMNS, names)


def summary(outcomes: list[Outcome], outputs: Path) -> str:
    """Compose the last line: the scenes, the wrong pixels of the monitor, and the place of the pictures."""
    results = [outcome.result for outcome in outcomes if outcome.result is not None]
    wrong, pixels = (sum(result[name] for result in results) for name in ("wrong_vs_golden", "pixels"))
    scenes = f"{len(results)} scene{'' if len(results) == 1 else 's'}"
    lost = f", {len(outcomes) - len(results)} failed" if len(results) < len(outcomes) else ""
    one = len(outcomes) == 1
    place = outputs / outcomes[0].run.name / "frame.png" if one else f"{outputs / SHEET} and {outputs}/*/frame.png"
    pictures = f"; picture{'' if one else 's'}: {place}" if results else ""
    screens = (outcome.run.configuration.whole_screen for outcome in outcomes)
    sizes = {
        f"{screen.horizontal.visible}x{screen.vertical.visible} for {screen.columns}x{screen.rows} rays": None
        for screen in screens
    }
    return f"{scenes}, {wrong:,} of {pixels:,} pixels wrong ({', '.join(sizes)}){lost}{pictures}"


def show_traces(outcomes: list[Outcome], options: Mapping[str, Any], simulator: str, console: Console) -> None:
    """Print the command that traces the first wrong pixel of each scene; say so if there is none."""
    for outcome in outcomes:
        configuration = outcome.run.configuration
        if outcome.result is None or not outcome.result["wrong_vs_golden"]:
            continue
        if configuration.fixed and not configuration.facts.whole_frames:
            console.print(
                f"{outcome.run.path.stem}: a design with FIX is not traced; try the scene without FIX", soft_wrap=True
            )
            continue
        column, row = outcome.result["first_wrong_ray"]
        asked = {"pixel": f"{column},{row}", **options}
        asked |= {"sim": simulator} if simulator != SIMULATORS[0] else {}
        command = command_line("trace", outcome.run.path, asked)
        console.print(f"to trace the first wrong pixel: {command}", soft_wrap=True)


def _frames_per_second(configuration: Configuration, row_cycles: int) -> float:
    """Pictures that could be computed per second."""
    screen = configuration.screen_geometry
    return screen.clock_hz / (screen.rows * row_cycles)


def check_list(run: Design) -> None:
    """Check that a list holds a frame of the scene; without lists, do nothing.

    Raises:
        UserError: it does not; the design would never show the scene.
    """
    configuration = run.configuration
    if not configuration.facts.whole_frames:
        return
    rows = frames.scene_rows(run.scene, configuration, run.reflections)
    frames.check_list(rows, configuration, run.path)


def _cells(outcome: Outcome) -> list[str | Text]:
    result, configuration = outcome.result, outcome.run.configuration
    if result is None:
        return [configuration.engine, Text("failed", "red")] + (len(COLUMNS) - 2) * [""]
    row, group, wrong = result["worst_row_cycles"], result["worst_group_cycles"], result["wrong_vs_golden"]
    screen, frame = configuration.screen_geometry, result["frame_cycles"]
    shares, alone, shown = ["", ""], "", ""
    if configuration.facts.whole_frames:
        alone, shown = f"{screen.clock_hz / frame:.0f}", frames.shown_hz(frame, configuration)
    else:
        shares = [f"{row / screen.row_cycles:.0%}", f"{group / configuration.group_budget:.0%}"]
        alone = f"{_frames_per_second(configuration, row):.0f}" if row else ""
    return [
        configuration.engine,
        Text(str(wrong), "red" if wrong else ""),
        str(result["wrong_vs_exact"]) if configuration.facts.divides else "",
        str(frame or ""),
        shares[0],
        Text("underrun", "red") if result["underrun"] else shares[1],
        alone,
        shown,
        f"{result['sim_seconds']:.2f}",
    ]


def command_parser() -> CommandParser:
    """Make the command's parser."""
    parser = CommandParser("sim", __doc__, "mirror_room --engine span")
    add_scene_argument(parser, "scenes to show (default: all packaged ones)", many=True)
    add_simulator_option(parser)
    parser.add_argument(
        "--gates",
        action="store_true",
        help="simulate the design's netlist, as a bitstream's flow places it; the default is a small design "
        f"({', '.join(f'{name} {value}' for name, value in GATES_OPTIONS.items())})",
    )
    parser.add_argument(
        "--cells", default="ecp5", metavar="FAMILY", help=f"chip of the netlist: {', '.join(LIBRARIES)} (%(default)s)"
    )
    parser.add_argument("--waves", action="store_true", help="write waveforms next to the pictures")
    parser.add_argument("--watch", action="store_true", help="show scenes again when one is saved, until Ctrl-C")
    add_build_option(parser)
    parser.add_argument(
        "--jobs", type=int, default=2, metavar="N", help="models to build, scenes to simulate at a time (default: 2)"
    )
    add_fix_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def _planned(arguments: argparse.Namespace, console: Console) -> list[Design]:
    """Plan the requested runs; by default a netlist is made of one small design, and shows only plain scenes."""
    options, gates = given_options(arguments), arguments.gates
    paths, missing = arguments.scene, {}
    if not paths and gates:
        plain = packaged_scenes(plain=True)
        paths = list(plain.values())
        others = [name for name in packaged_scenes() if name not in plain]
        console.print(f"left out, as a netlist shows plain scenes: {', '.join(others)}", soft_wrap=True)
    elif not paths:
        paths, missing = packaged_for(options), left_out(options)
    small = dict(GATES_OPTIONS) if gates else {}
    engine = ENGINES.get(options.get("engine", ""))
    if engine is not None and engine.facts.whole_frames:
        small.pop("units", None)  # one unit of such an engine shows all scenes
    runs = plan_runs(paths, options, small, arguments.fix, console)
    for reason, names in missing.items():
        console.print(f"left out, as each {reason}: {', '.join(names)}", soft_wrap=True)
    return runs


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that draws the scenes."""
    return verilog_digest(*configurations(_planned(arguments, Console(quiet=True))))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    # make exports its variables, which cocotb would take for its own.
    for name in ("WAVES", "GUI"):
        os.environ.pop(name, None)
    if arguments.cells not in LIBRARIES:
        raise UserError(f"cells: expected {' or '.join(LIBRARIES)}, got {arguments.cells}")
    if arguments.watch and not arguments.scene:
        raise UserError(f"{as_typed('watch', True)}: needs the scenes to watch")
    return _watch(arguments, Console()) if arguments.watch else _show(arguments, Console())


def _watch(arguments: argparse.Namespace, console: Console) -> int:
    """Show the scenes, and again each time a file is saved; a mistake in a file is one line. Ctrl-C ends it."""
    while True:
        saved = _times_saved(arguments.scene)
        try:
            _show(arguments, console)
        except UserError as error:
            console.print(f"error: {printable(str(error))}", style="red", soft_wrap=True)
        console.print("Save a scene to show it again; Ctrl-C ends.", style="dim")
        try:
            while _times_saved(arguments.scene) == saved:
                time.sleep(POLL_SECONDS)
        except KeyboardInterrupt:
            return 0


def _times_saved(paths: Iterable[Path]) -> list[int | None]:
    """Return when each file was last saved; None while an editor replaces it."""
    return [path.stat().st_mtime_ns if path.exists() else None for path in paths]


def _show(arguments: argparse.Namespace, console: Console) -> int:
    """Show the scenes once, and return the exit code."""
    gates, jobs = arguments.gates, max(1, arguments.jobs)
    runs = _planned(arguments, console)
    engines = dict.fromkeys(run.configuration.engine for run in runs)
    told = given_options(arguments) | ({"fix": arguments.fix} if arguments.fix else {})
    told |= {"cells": arguments.cells} if gates else {}
    outputs = output_directory(arguments.build, [*engines], told, "gates" if gates else "sim")
    for run in runs:
        check_replaceable(outputs / run.name)
        check_list(run)
    find_tool(arguments.simulator)
    if gates:
        find_yosys()
    try:
        netlists = synthesise_all(runs, arguments.build, arguments.cells, console) if gates else {}
        models = build_models(runs, arguments.simulator, arguments.waves, arguments.build, netlists, jobs, console)
    except SimulationError as error:
        console.print(str(error), style="red", soft_wrap=True)
        return 1
    outcomes = run_all(runs, models, outputs, jobs, console)
    tidy(outputs, outcomes)
    if gates:
        show_cells(netlists, console)
    show(outcomes, console, "through the netlist" if gates else None)
    if len(outcomes) > 1:
        write_sheet(outcomes, outputs / SHEET)
    figures = [{"scene": one.run.path.stem, **one.result} for one in outcomes if one.result is not None]
    keep(arguments, {"scenes": figures}, verilog)
    if not gates:
        show_traces(outcomes, told, arguments.simulator, console)
    console.print(summary(outcomes, outputs), soft_wrap=True)
    return int(any(outcome.failure for outcome in outcomes))
