# SPDX-License-Identifier: MIT
"""Measure what the regression exercises in an engine: `make coverage`.

Code: lines, conditions and toggles of the converted Verilog, in the benches of the whole design. Function: kinds of
intersection of a ray with a rectangle and of hit points in a light, in all scenes and in random ones, whose pixels the
benches compare with the golden model. Every hole must be closed or explained.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
from rich.text import Text

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration, configure
from raycaster.convert.digest import verilog_digest
from raycaster.errors import UserError
from raycaster.jobs import Kept, add_fresh_option, processes, run_jobs
from raycaster.options import CommandParser
from raycaster.outcomes import add_keep_option, keep
from raycaster.output import Console, Table, emptied
from raycaster.scene import find_scene, load_scene, packaged_scenes
from raycaster.sim.job import Job
from raycaster.sim.simulator import (
    BUILD,
    MODULE_BENCH,
    VERILATOR_FLAGS,
    Model,
    SimulationError,
    announced,
    build_model,
    run_bench,
)
from raycaster.verif.campaign import Campaign, bench_digest, run_campaign
from raycaster.verif.coverage.code import KINDS, Judgement, Point, describe, judge, load_explanations, read_counts
from raycaster.verif.coverage.functional import Cross, FunctionalCoverage
from raycaster.verif.coverage.intersections import count_intersections, cross_of
from raycaster.verif.coverage.lighting import HIT_POINTS, count_hit_points
from raycaster.verif.random_scenes import random_scene
from raycaster.verif.soak.soak import BENCH as SOAK

# One design per engine that every bench can run, so that nothing must be merged; at full size, so that the counters run
# through their range. The seed engine has 16 units, not 32, and so a budget of 159 cycles per group. All 12 rectangles
# with two reflections take 202 cycles; with culling, more than 159 remain only where the underrun bench needs them.
# Likewise for the exact engine with eight units: 112 cycles with shadow passes, and a budget of 79.
DESIGNS = {
    config.engine: config
    for config in (
        configure(units=16, reflections=2, divider_bits=2, allow_underrun=True),
        configure(engine="exact", units=8, reflections=2, culling=True, light=True, allow_underrun=True),
        configure(engine="beam", scale=1, reflections=2),
    )
}
SOAK_DESIGNS = {
    config.engine: config
    for config in (
        configure(reflections=2),
        configure(engine="exact", reflections=2, culling=True, light=True),
        configure(engine="beam", reflections=2),
    )
}
"""Designs for random scenes, which take a fraction of the time without coverage counters."""

FLAGS = (
    *VERILATOR_FLAGS,
    "--coverage-line",
    "--coverage-expr",
    "--coverage-toggle",
    # The widest bus of the design; the bench's buffer for a line is wider.
    "--coverage-max-width",
    "1024",
)


@dataclass(frozen=True)
class Run:
    """A run of a bench."""

    bench: str
    scene: Path | None = None
    """Scene file, if the bench needs one."""

    reflections: int | None = None
    """Overrides the reflections of the scene."""

    @property
    def name(self) -> str:
        """Name of the directory of the run."""
        return f"{self.bench}-{self.scene.stem}" if self.scene else self.bench


BENCHES = (
    # With culling it meets the row budget even with two reflections.
    Run("verif.benches.register_bench", find_scene("floor"), 2),
    Run("verif.benches.underrun_bench"),
    Run("verif.coverage.bench"),
)
"""Runs in addition to a frame of every scene, longest first."""

EXTRA_SCENES = tuple(sorted(Path(__file__).parent.glob("extra_*.toml")))
"""Scenes for intersections and shadows that random scenes rarely have."""


def run_all(
    model: Model, runs: Sequence[Run], output: Path, jobs: int, console: Console, *, fresh: bool = False
) -> tuple[Counter[Point], list[str]]:
    """Run benches, `jobs` at a time, on a model with coverage counters; `fresh` as in `Kept`.

    Returns:
        The sum of all counts, and the messages of failed runs.
    """
    counts: Counter[Point] = Counter()
    failures = []
    directories = {run: (output / _digest(run, model) / run.name).resolve() for run in runs}
    kept = Kept(lambda run: directories[run] / "kept.pickle", fresh, complete=lambda found: not found[1])
    runner = partial(_run, model=model, directories=directories)
    for found, failure in run_jobs("benches", runner, runs, processes(jobs), console, kept=kept):
        counts.update(found)
        failures += [failure] if failure else []
    return counts, failures


def _digest(run: Run, model: Model) -> str:
    scene = run.scene.read_text() if run.scene else ""
    return bench_digest(f"raycaster.{run.bench}", model, scene, run.reflections)


def _run(run: Run, model: Model, directories: Mapping[Run, Path]) -> tuple[Counter[Point], str]:
    """Return the counts of a run, and its message if it failed."""
    directory = directories[run]
    emptied(directory)
    scene = str(run.scene.resolve()) if run.scene else ""
    job = Job(model.configuration, scene=scene, output=str(directory), reflections=run.reflections)
    counts_file = directory / "coverage.dat"
    try:
        run_bench(model, f"raycaster.{run.bench}", job, directory, plusargs=[f"+verilator+coverage+file+{counts_file}"])
    except SimulationError as error:
        return Counter(), f"{run.name}: {error}"
    return read_counts(counts_file, leave_out=MODULE_BENCH.modules), ""


def show_code(counts: Counter[Point], judgement: Judgement, console: Console) -> None:
    """Print a line per module, the explanations, holes without an explanation, and explanations without a hole."""
    table = Table("module", *KINDS, "explained", "holes", title="Code coverage: hit / all")
    modules = sorted({point.module for point in counts})
    for module in (*modules, None):
        cells = [_share(*_hits(counts, module, types)) for types in KINDS.values()]
        explained = sum(module in (None, point.module) for point in judgement.explained)
        holes = sum(module in (None, point.module) for point in judgement.unexplained)
        if module is None:
            table.add_section()
        table.add_row(module or "all", *cells, explained, Text(str(holes), "red" if holes else ""))
    console.print(table)
    console.print("Points that cannot be hit, by explanation:")
    for reason, number in Counter(explanation.reason for explanation in judgement.explained.values()).items():
        console.print(f"  {number}: {reason}")
    for line in describe(judgement.unexplained):
        console.print(f"not covered: {line}", style="red", soft_wrap=True)
    for stale in judgement.stale:
        console.print(f"stale explanation: {stale}", style="red", soft_wrap=True)


def _hits(counts: Counter[Point], module: str | None, types: Sequence[str]) -> tuple[int, int]:
    chosen = [count > 0 for point, count in counts.items() if module in (None, point.module) and point.kind in types]
    return sum(chosen), len(chosen)


def _share(hit: int, total: int) -> str:
    return f"{hit} / {total} {100 * hit / total:5.1f} %" if total else ""


def export_code(counts: Counter[Point], judgement: Judgement, path: Path) -> None:
    """Write the numbers of hit and of all points by module, and every hole with its reason, as JSON."""
    modules = {
        module: {name: _hits(counts, module, types) for name, types in KINDS.items()}
        for module in sorted({point.module for point in counts})
    }
    holes = [
        {"file": point.file.name, "line": point.line, "kind": point.kind, "what": point.what, "reason": reason}
        for point, reason in [
            *((point, None) for point in judgement.unexplained),
            *((point, explanation.reason) for point, explanation in judgement.explained.items()),
        ]
    ]
    path.write_text(json.dumps({"modules": modules, "holes": holes, "stale": judgement.stale}, indent=1) + "\n")


def show_functional(functional: FunctionalCoverage, scenes: int, console: Console) -> None:
    """Print the counts of the cross, with blanks for impossible bins, and the bins that were not hit."""
    bins, name = functional.bins, functional.cross.name.replace("_", " ")
    *where, results, details, rays = functional.cross.points.values()
    columns = list(product(*where))
    rows = [row for row in product(results, details) if any((*column, *row, "first") in bins for column in columns)]
    signs = {"negative": "-", "zero": "0", "positive": "+"}
    for ray in rays:
        headings = (" ".join(signs.get(part, part) for part in column) for column in columns)
        table = Table("result", *headings, title=f"{name}, {ray} ray")
        for result, detail in rows:
            times = [bins.get((*column, result, detail, ray)) for column in columns]
            cells = [Text("" if n is None else f"{n:,}", "red" if n == 0 else "") for n in times]
            table.add_row(result if detail == "none" else f"{result}, {detail}", *cells)
        console.print(table)
    console.print(
        f"{len(bins) - len(functional.holes)} of {len(bins)} bins hit in {scenes} scenes, {sum(bins.values()):,} "
        f"{name}; left out as impossible:",
    )
    for reason, number in functional.ignored.items():
        console.print(f"  {number}: {reason}")
    for hole in functional.holes:
        console.print(f"not hit: {', '.join(hole)}", style="red")


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify coverage", __doc__, "--seeds 10")
    parser.add_argument(
        "--engine", choices=list(DESIGNS), default="seed", metavar="NAME", help=f"{', '.join(DESIGNS)} (default: seed)"
    )
    parser.add_argument("--seeds", type=int, default=100, metavar="N", help="random scenes (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="simulations at a time (default: %(default)s)")
    parser.add_argument("--build", type=Path, default=BUILD, metavar="DIR", help="directory of all output")
    add_fresh_option(parser)
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that is covered."""
    return verilog_digest(DESIGNS[arguments.engine], SOAK_DESIGNS[arguments.engine])


def functions_of(design: Configuration) -> list[tuple[Cross, Callable[..., np.ndarray]]]:
    """List the crosses of a design, each with the function that counts its bins in a scene."""
    intersections = cross_of(design), count_intersections
    return [intersections, (HIT_POINTS, count_hit_points)] if design.light else [intersections]


def main(argv: list[str] | None = None) -> int:
    """Run the command.

    Args:
        argv: its arguments, those of the process by default.

    Returns:
        Its exit code: 1 for a hole without an explanation, an explanation without a hole, or a failed run.
    """
    arguments = command_parser().parse_args(argv)
    if arguments.seeds < 1 or arguments.jobs < 1:
        raise UserError(f"{as_typed('seeds')} and {as_typed('jobs')} must be at least 1")
    design, soaked_design = DESIGNS[arguments.engine], SOAK_DESIGNS[arguments.engine]
    explanations = load_explanations(arguments.engine)
    extra = [path for path in EXTRA_SCENES if not load_scene(path).lacks(design.looks)]
    scenes = [*packaged_scenes(plain=True).values(), *extra]
    # For a file or a pipe rich would assume 80 columns, too few for the tables.
    console = Console()
    output = arguments.build / "coverage"
    output.mkdir(parents=True, exist_ok=True)
    started = time.perf_counter()

    with announced(console, f"building {design.name}", design.engine):
        counting = build_model(design, build=arguments.build, flags=FLAGS)
    runs = [*BENCHES, *(Run("sim.frame_bench", scene) for scene in scenes)]
    counts, failures = run_all(counting, runs, output / "runs", arguments.jobs, console, fresh=arguments.fresh)
    judgement = judge(counts, explanations)

    export_code(counts, judgement, output / "code.json")
    show_code(counts, judgement, console)
    seeds = range(arguments.seeds)
    whole = Campaign(SOAK, soaked_design, seeds, output / "soak", arguments.build, fresh=arguments.fresh)
    soaked = run_campaign(whole, console, processes(arguments.jobs))
    failures += soaked.failures
    room, most = soaked_design.rectangles, soaked_design.reflections
    drawn = [load_scene(path) for path in scenes]
    drawn += [random_scene(result["seed"], room, most, soaked_design.looks) for result in soaked.results]
    figures: dict[str, object] = {"scenes": len(drawn)}
    figures |= {name: _hits(counts, None, types) for name, types in KINDS.items()}
    holes, bins = 0, 0
    for cross, count in functions_of(design):
        counter, executor = partial(count, config=soaked_design), processes(arguments.jobs)
        functional = FunctionalCoverage(cross)
        for part in run_jobs("golden pictures", counter, drawn, executor, console):
            functional.add(part)
        functional.export(output / cross.name)
        show_functional(functional, len(drawn), console)
        figures[cross.name] = sum(functional.bins.values())
        holes, bins = holes + len(functional.holes), bins + len(functional.bins)
    figures["bins"] = bins - holes, bins
    left_out = "the other engines, a camera that turns, materials and patterns"
    keep(arguments, figures, verilog, left_out)
    for failure in failures:
        console.print(failure, style="red", soft_wrap=True)
    console.print(f"{time.perf_counter() - started:.0f} s; figures and holes are in {output}/")
    return verdict(judgement, holes, failures)


def verdict(judgement: Judgement, holes: int, failures: Sequence[str]) -> int:
    """Return the exit code; holes are those of functional coverage."""
    return int(bool(judgement.unexplained or judgement.stale or holes or failures))
