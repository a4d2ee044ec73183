# SPDX-License-Identifier: MIT
"""Draw random or stiff scenes with the converted hardware, at full size, and check every pixel: `make soak`.

Random scenes are new each day; SEED= repeats those of another one.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import raycaster
from raycaster import golden, sim
from raycaster.configuration import MOST_REFLECTIONS, MOST_RUNS, Configuration
from raycaster.convert.digest import verilog_digest
from raycaster.design.decide import configure
from raycaster.design.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    command_line,
    given_options,
)
from raycaster.output import Console, Table, emptied
from raycaster.runs.digests import digest
from raycaster.runs.jobs import Kept, add_fresh_option, add_job_options, executors, natural, positive, run_jobs
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.sim.job import Job
from raycaster.sim.simulator import (
    Model,
    SimulationError,
    add_simulator_option,
    announced,
    build_model,
    run_bench,
)
from raycaster.verif import benches, random_scenes
from raycaster.verif.catalogue import catalogue
from raycaster.verif.random_scenes import style_of
from raycaster.verif.seeds import add_seed_option, drawn

BENCH = "raycaster.verif.soak.bench"

SCENES_PER_SEED = 10_000
"""Distance between the first scenes of two days, so that each day has new ones."""


@dataclass(frozen=True)
class Share:
    """Scenes that one simulation draws; its directory gets their results."""

    model: Model
    seeds: range
    output: Path
    stiff: bool

    @property
    def directory(self) -> Path:
        """Directory of the simulation, below one whose name depends on everything that decides the results."""
        return (self.output / bench_digest(BENCH, self.model, self.stiff) / f"from{self.seeds[0]}").resolve()

    def place(self) -> Path:
        """Return the file that keeps the results."""
        return self.directory / f"kept-{len(self.seeds)}.pickle"

    def run(self) -> tuple[list[dict], str]:
        """Run the simulation; return its results, and its message if it failed."""
        emptied(self.directory)  # a worker that died may have left files
        job = Job(self.model.configuration, output=str(self.directory), seeds=tuple(self.seeds), stiff=self.stiff)
        failure = ""
        try:
            run_bench(self.model, BENCH, job, self.directory)
        except SimulationError as error:
            failure = str(error)
        results = self.directory / "results.jsonl"
        lines = results.read_text().splitlines() if results.exists() else []
        return [json.loads(line) for line in lines], failure


def bench_digest(bench: str, model: Model, *parts: object) -> str:
    """Digest a bench on a model, the golden model, everything that they import, and `parts`.

    The name of the model's directory already has a digest of the Verilog and of the options of the build.
    """
    spec = importlib.util.find_spec(bench)
    assert spec and spec.origin, f"{bench} is no module"
    packages = (Path(package.__path__[0]) for package in (raycaster, golden, sim, benches))
    sources = Path(spec.origin), Path(random_scenes.__file__)
    return digest(model.directory.name, model.configuration, *sources, *packages, *parts)


def show(
    results: list[dict], seconds: float, configuration: Configuration, console: Console, *, stiff: bool = False
) -> None:
    """Print the results, by style and reflections."""
    rows: dict[tuple[str, int], list[dict]] = defaultdict(list)
    for result in results:
        rows["stiff" if stiff else style_of(result["seed"]), result["reflections"]].append(result)
    title = f"{configuration.name}, {len(results)} scenes in {seconds:.0f} s"
    table = Table("style", "reflections", "scenes", "pixels", "wrong", "against exact", title=title)
    for (style, reflections), group in [*sorted(rows.items()), (("all", ""), results)]:
        pixels, wrong, rounding = (
            sum(result[name] for result in group) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")
        )
        # The golden model of an engine that does not round is exact, so there is no rounding to count.
        share = f"{100 * rounding / pixels:.2f} %" if pixels and configuration.facts.divides else ""
        table.add_row(style, reflections, len(group), pixels, wrong, share)
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify soak", __doc__, "--seeds 10")
    parser.add_argument("--stiff", action="store_true", help="run all cases of the stiff catalogue instead")
    add_simulator_option(parser)
    add_seed_option(parser)
    parser.add_argument(
        "--seeds", type=positive, default=100, metavar="N", help="number of scenes (default: %(default)s)"
    )
    first = f"number of the first scene (default: {SCENES_PER_SEED:,} times the seed)"
    parser.add_argument("--first", type=natural, metavar="N", help=first)
    add_job_options(parser)
    add_fresh_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def _configuration(arguments: argparse.Namespace) -> Configuration:
    """Return the design that draws the scenes; a random one may have a run per column, so its lists hold as many."""
    options = {"reflections": MOST_REFLECTIONS} | given_options(arguments)
    config = configure(**options)
    if config.facts.whole_frames and "list" not in options:
        config = configure(**options, list=min(config.rows * config.screen_geometry.columns, MOST_RUNS))
    return config


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that draws the scenes."""
    return verilog_digest(_configuration(arguments))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    configuration, console = _configuration(arguments), Console()
    output, seeds = arguments.build / "soak", range(len(catalogue(configuration.features)))
    if not arguments.stiff:
        options, first = {"seeds": arguments.seeds} | given_options(arguments), arguments.first
        if first is None:
            first = SCENES_PER_SEED * drawn("verify soak", arguments.seed, None, console, **options)
        seeds = range(first, first + arguments.seeds)
    with announced(console, f"building {configuration.name}", configuration.facts):
        model = build_model(configuration, arguments.simulator, build=arguments.build)
    output.mkdir(parents=True, exist_ok=True)
    started = time.perf_counter()
    count = min(max(len(seeds) // 20, 5), 20)  # a simulation takes a scene's time to start
    firsts = range(0, len(seeds), count)
    shares = [Share(model, seeds[first : first + count], output, arguments.stiff) for first in firsts]
    kept = Kept(Share.place, arguments.fresh, complete=lambda found: not found[1])
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        found = run_jobs("simulations", Share.run, shares, make_executor, console, kept=kept)
    results = [result for of_share, _ in found for result in of_share]
    (output / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results))
    show(results, time.perf_counter() - started, configuration, console, stiff=arguments.stiff)
    counts = {name: sum(one[name] for one in results) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")}
    missing = len(seeds) - len(results)
    keep(arguments, {"scenes": len(results), "first": seeds.start, "not_shown": missing, **counts}, verilog)
    complaints = []
    for result in results:
        if result["wrong_vs_golden"]:
            which = {"stiff": True} if arguments.stiff else {"seeds": 1, "first": result["seed"]}
            repeated = command_line("verify soak", options=which | given_options(arguments))
            complaints.append(
                f"seed {result['seed']}: {result['wrong_vs_golden']} wrong pixels; the scene, whole and shrunk, "
                f"is in {output}/*/from*/{result['seed']}*.toml; repeat with: {repeated}"
            )
    complaints += [failure for _, failure in found if failure]
    complaints += [f"{missing} scenes have no result"] if missing else []
    for complaint in complaints:
        console.print(complaint, style="red", soft_wrap=True)
    return 1 if complaints else 0
