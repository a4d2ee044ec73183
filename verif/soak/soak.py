# SPDX-License-Identifier: MIT
"""Random or stiff scenes through the converted hardware at full size, every pixel held against golden: `make soak`."""

from __future__ import annotations

import json
import shutil
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

from raycaster.configuration import Configuration, configure
from raycaster.errors import UserError
from raycaster.golden.catalogue import catalogue
from raycaster.jobs import add_job_options, executors, run_jobs
from raycaster.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    command_line,
    given_options,
)
from raycaster.outcomes import add_keep_option, keep, scope_of
from raycaster.sim.job import Job
from raycaster.sim.simulator import SimulationError, add_simulator_option, build_model, run_bench
from raycaster.verif.random_scenes import style_of

SHARE = 5
"""Scenes of a simulation: a few, so that the bar moves and little is lost with a worker."""


@dataclass(frozen=True)
class Share:
    """Some of the scenes, for one simulation."""

    configuration: Configuration
    simulator: str
    seeds: range
    output: Path
    """Of all of them."""

    build: Path
    stiff: bool


def soak(
    whole: Share, console: Console, make_executor: Callable[[], Executor] = ProcessPoolExecutor
) -> tuple[list[dict], list[str]]:
    """Show the scenes of all seeds, some at a time.

    Args:
        whole: all seeds, each of which makes a scene, or is its place in the stiff catalogue; its output is replaced:
            `results.jsonl` is all results, failing scenes are `<seed>.toml` and `<seed>-shrunk.toml`.
        console: for the progress bar.
        make_executor: see `raycaster.jobs.executors`.

    Returns:
        The results by seed, and what each failed simulation said.
    """
    shutil.rmtree(whole.output, ignore_errors=True)
    shares = [replace(whole, seeds=whole.seeds[first : first + SHARE]) for first in range(0, len(whole.seeds), SHARE)]
    found = run_jobs("simulations", run_share, shares, make_executor, console)
    results = [result for share, _ in found for result in share]
    whole.output.mkdir(parents=True, exist_ok=True)
    (whole.output / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results))
    return results, [failure for _, failure in found if failure]


def run_share(share: Share) -> tuple[list[dict], str]:
    """The results of one simulation, and what it said if it failed."""
    directory = (share.output / f"from{share.seeds[0]}").resolve()
    shutil.rmtree(directory, ignore_errors=True)  # a worker that died may have begun it
    directory.mkdir(parents=True)
    job = Job(share.configuration, output=str(directory), seeds=tuple(share.seeds), stiff=share.stiff)
    failure = ""
    try:
        model = build_model(share.configuration, share.simulator, build=share.build)
        run_bench(model, "raycaster.verif.soak.bench", job, directory)
    except SimulationError as error:
        failure = str(error)
    results = directory / "results.jsonl"
    lines = results.read_text().splitlines() if results.exists() else []
    return [json.loads(line) for line in lines], failure


def show(
    results: list[dict], seconds: float, configuration: Configuration, console: Console, *, stiff: bool = False
) -> None:
    """Print what was checked, by style and reflections."""
    rows: dict[tuple[str, int], list[dict]] = defaultdict(list)
    for result in results:
        rows["stiff" if stiff else style_of(result["seed"]), result["reflections"]].append(result)
    table = Table(title=f"{configuration.name}, {len(results)} scenes in {seconds:.0f} s")
    table.add_column("style")
    for heading in ("reflections", "scenes", "pixels", "wrong", "against exact"):
        table.add_column(heading, justify="right")
    for (style, reflections), group in [*sorted(rows.items()), (("all", ""), results)]:
        pixels = sum(result["pixels"] for result in group)
        rounding = sum(result["wrong_vs_exact"] for result in group)
        wrong = sum(result["wrong_vs_golden"] for result in group)
        share = f"{100 * rounding / pixels:.2f} %" if pixels else ""
        table.add_row(style, str(reflections), str(len(group)), f"{pixels:,}", f"{wrong:,}", share)
    console.print(table)


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("verify soak", __doc__, "--seeds 10")
    parser.add_argument("--seeds", type=int, default=100, metavar="N", help="how many scenes (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first one's (default: %(default)s)")
    parser.add_argument("--stiff", action="store_true", help="all cases of the stiff catalogue instead")
    add_job_options(parser)
    add_simulator_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns its exit code."""
    arguments = command_parser().parse_args(argv)
    if arguments.seeds < 1 or arguments.first < 0:
        raise UserError("seeds: must be 1 or more, first: 0 or more")
    configuration = configure(**{"reflections": 2} | given_options(arguments))
    console = Console()
    with console.status(f"building {configuration.name}"):
        build_model(configuration, arguments.simulator, build=arguments.build)  # which the workers find
    started = time.perf_counter()
    output = arguments.build / "soak"
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    if arguments.stiff:
        seeds = range(len(catalogue(configuration.looks)))
    whole = Share(configuration, arguments.simulator, seeds, output, arguments.build, arguments.stiff)
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        results, failures = soak(whole, console, make_executor)
    show(results, time.perf_counter() - started, configuration, console, stiff=arguments.stiff)
    for result in results:
        if result["wrong_vs_golden"]:
            which = {"stiff": True} if arguments.stiff else {"seeds": 1, "first": result["seed"]}
            repeat = command_line("verify soak", options=which | given_options(arguments))
            console.print(
                f"seed {result['seed']}: {result['wrong_vs_golden']} wrong pixels; the scene, and what it shrinks to, "
                f"is in {output}/from*/{result['seed']}*.toml; repeat with: {repeat}",
                style="red",
                soft_wrap=True,
            )
    for failure in failures:
        console.print(failure, style="red", markup=False, soft_wrap=True)
    missing = len(seeds) - len(results)
    counts = {name: sum(one[name] for one in results) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")}
    figures = {"scenes": len(results), "not_shown": missing, **counts}
    keep(arguments, figures, scope_of(configuration) | {"stiff": arguments.stiff})
    if missing:
        console.print(f"{missing} scenes were not shown", style="red")
    return int(bool(failures) or bool(missing))
