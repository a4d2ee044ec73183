# SPDX-License-Identifier: MIT
"""Random or stiff scenes through the converted hardware at full size, every pixel held against golden: `make soak`."""

from __future__ import annotations

import json
import shutil
import time
from collections import defaultdict
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from raycaster.configuration import Configuration, configure
from raycaster.errors import UserError
from raycaster.golden.catalogue import catalogue
from raycaster.options import CommandParser, add_build_option, add_configuration_options, given_options
from raycaster.sim.job import Job
from raycaster.sim.simulator import Model, SimulationError, add_simulator_option, build_model, run_bench
from raycaster.verif.random_scenes import style_of

POLL_SECONDS = 0.2


def soak(
    model: Model, seeds: range, output: Path, jobs: int, console: Console, *, stiff: bool = False
) -> tuple[list[dict], list[str]]:
    """Show the scenes of all seeds, some at a time.

    Args:
        model: a built design.
        seeds: each makes a scene.
        output: replaced; `results.jsonl` is all results, failing scenes are `<seed>.toml` and `<seed>-shrunk.toml`.
        jobs: simulations at a time.
        console: for the progress bar.
        stiff: the seeds are places in the stiff catalogue.

    Returns:
        The results by seed, and what each failed simulation said.
    """
    shutil.rmtree(output, ignore_errors=True)
    shares = [seeds[share::jobs] for share in range(min(jobs, len(seeds)))]
    directories = [output / f"job{share}" for share in range(len(shares))]
    failures = []
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bars, ThreadPoolExecutor(jobs) as pool:
        bar = bars.add_task("scenes", total=len(seeds))
        futures = [
            pool.submit(_run, model, share, directory, stiff)
            for share, directory in zip(shares, directories, strict=True)
        ]
        pending = set(futures)
        while pending:
            _, pending = wait(pending, timeout=POLL_SECONDS)
            counts = [(directory / "progress") for directory in directories]
            bars.update(bar, completed=sum(int(count.read_text() or 0) for count in counts if count.exists()))
        for future in futures:
            try:
                future.result()
            except SimulationError as error:
                failures.append(str(error))
    lines = [line for directory in directories for line in _lines(directory / "results.jsonl")]
    results = sorted(map(json.loads, lines), key=lambda result: result["seed"])
    (output / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results))
    return results, failures


def _run(model: Model, seeds: range, directory: Path, stiff: bool) -> None:
    directory.mkdir(parents=True)
    job = Job(
        configuration=model.configuration,
        output=str(directory.resolve()),
        progress=str((directory / "progress").resolve()),
        seeds=tuple(seeds),
        stiff=stiff,
    )
    run_bench(model, "raycaster.verif.soak.bench", job, directory)


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


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


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns its exit code."""
    parser = CommandParser("verify soak", __doc__, "--seeds 10")
    parser.add_argument("--seeds", type=int, default=100, metavar="N", help="how many scenes (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first one's (default: %(default)s)")
    parser.add_argument("--stiff", action="store_true", help="all cases of the stiff catalogue instead")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="simulations at a time (default: %(default)s)")
    add_simulator_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)
    arguments = parser.parse_args(argv)
    if arguments.seeds < 1 or arguments.jobs < 1 or arguments.first < 0:
        raise UserError("seeds and jobs: must be 1 or more, first: 0 or more")
    configuration = configure(**{"reflections": 2} | given_options(arguments))
    console = Console()
    with console.status(f"building {configuration.name}"):
        model = build_model(configuration, arguments.simulator, build=arguments.build)
    started = time.perf_counter()
    output = arguments.build / "soak"
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    if arguments.stiff:
        seeds = range(len(catalogue()))
    results, failures = soak(model, seeds, output, arguments.jobs, console, stiff=arguments.stiff)
    show(results, time.perf_counter() - started, configuration, console, stiff=arguments.stiff)
    options = " ".join(f"{name.upper()}={value}" for name, value in given_options(arguments).items())
    repeat = f"STIFF=1 {options}" if arguments.stiff else f"SEEDS=1 FIRST={{}} {options}"
    for result in results:
        if result["wrong_vs_golden"]:
            console.print(
                f"seed {result['seed']}: {result['wrong_vs_golden']} wrong pixels; the scene, and what it shrinks to, "
                f"is in {output}/job*/{result['seed']}*.toml; repeat with: make soak {repeat.format(result['seed'])}",
                style="red",
                soft_wrap=True,
            )
    for failure in failures:
        console.print(failure, style="red", markup=False, soft_wrap=True)
    missing = len(seeds) - len(results)
    if missing:
        console.print(f"{missing} scenes were not shown", style="red")
    return int(bool(failures) or bool(missing))
