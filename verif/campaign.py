# SPDX-License-Identifier: MIT
"""A long run of numbered cases through a bench, several per simulation, that can be resumed after an interruption."""

from __future__ import annotations

import argparse
import importlib.util
import json
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import raycaster
from raycaster import golden, sim
from raycaster.configuration import Configuration
from raycaster.digests import digest
from raycaster.jobs import Kept, add_fresh_option, add_job_options, executors, natural, positive, run_jobs
from raycaster.options import add_build_option, add_configuration_options, command_line, given_options
from raycaster.outcomes import add_keep_option
from raycaster.output import Console, emptied
from raycaster.sim.job import Job
from raycaster.sim.simulator import VERILATOR_FLAGS, Model, SimulationError, announced, build_model, run_bench
from raycaster.verif import benches, random_scenes


@dataclass(frozen=True)
class Campaign:
    """All cases of a campaign, or those of one of its simulations.

    Attributes:
        bench: module of the cocotb test. It takes case numbers from the job's seeds and writes a line of JSON per case
            to `results.jsonl` in the job's output directory.
        configuration: the design.
        cases: numbers of the cases.
        output: directory of the campaign: `results.jsonl` holds all results, `<digest>/from<number>` the output of one
            simulation. The digest covers everything that decides the results.
        build: directory that holds `model/`.
        simulator: one of `SIMULATORS`.
        flags: for Verilator.
        stiff: passed on to the job.
        registers: passed on to the job.
        share: number of cases per simulation; 0 chooses one.
        fresh: repeat simulations that an earlier run of the command has completed.
    """

    bench: str
    configuration: Configuration
    cases: range
    output: Path
    build: Path
    simulator: str = "verilator"
    flags: Sequence[str] = VERILATOR_FLAGS
    stiff: bool = False
    registers: Mapping[str, Sequence[str]] = field(default_factory=dict)
    share: int = 0
    fresh: bool = False


@dataclass(frozen=True)
class Outcome:
    """Results of a campaign.

    Attributes:
        results: in the order of the cases.
        failures: message of each failed simulation.
        missing: number of cases without a result.
        seconds: wall-clock time of the simulations of this run.
    """

    results: list[dict]
    failures: list[str]
    missing: int
    seconds: float

    def verdict(self, cases: str, console: Console, wrong: Sequence[str] = ()) -> int:
        """Print complaints about cases, failures, and how many `cases` have no result; return the exit code.

        A case that is wrong has failed its simulation too.
        """
        for failure in [*wrong, *self.failures]:
            console.print(failure, style="red", soft_wrap=True)
        if self.missing:
            console.print(f"{self.missing} {cases} have no result", style="red")
        return int(bool(self.failures or self.missing))


def add_campaign_options(parser: argparse.ArgumentParser, cases: str, count: int, first: int | str = 0) -> None:
    """Add the options of a campaign's command, whose cases are called `cases`, such as scenes.

    The first one is a number, or a text that describes it.
    """
    parser.add_argument(
        f"--{cases}", type=positive, default=count, metavar="N", help=f"number of {cases} (default: %(default)s)"
    )
    number = first if isinstance(first, int) else None
    parser.add_argument(
        "--first", type=natural, default=number, metavar="N", help=f"the first of the {cases} (default: {first})"
    )
    add_job_options(parser)
    add_fresh_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)


def run_asked(campaign: Campaign, arguments: argparse.Namespace, console: Console) -> Outcome:
    """Run all cases with the job options of a command."""
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        return run_campaign(replace(campaign, fresh=arguments.fresh), console, make_executor)


def repeated(command: str, arguments: argparse.Namespace, **options: Any) -> str:
    """Return the command line that repeats a case with the design of a command."""
    return f"repeat with: {command_line(command, options=options | given_options(arguments))}"


def run_campaign(
    campaign: Campaign, console: Console, make_executor: Callable[[], Executor] = ProcessPoolExecutor
) -> Outcome:
    """Run all cases, in executors as in `raycaster.jobs.executors`, with a progress bar on the console.

    Raises:
        UserError: a tool is missing.
        SimulationError: the model cannot be built.
    """
    with announced(console, f"building {campaign.configuration.name}", campaign.configuration.engine):
        model = _build(campaign)  # once, for all workers
    started = time.perf_counter()
    output = campaign.output / bench_digest(campaign.bench, model, campaign.stiff, dict(campaign.registers))
    cases = campaign.cases
    share = campaign.share or min(max(len(cases) // 20, 5), 20)  # a simulation takes a scene's time to start
    firsts = range(0, len(cases), share)
    shares = [replace(campaign, output=output, cases=cases[first : first + share]) for first in firsts]
    kept = Kept(_place, campaign.fresh, complete=lambda found: not found[1])
    found = run_jobs("simulations", run_share, shares, make_executor, console, kept=kept)
    results = [result for results, _ in found for result in results]
    (campaign.output / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results))
    failures = [failure for _, failure in found if failure]
    seconds = time.perf_counter() - started
    return Outcome(results, failures, len(cases) - len(results), seconds)


def bench_digest(bench: str, model: Model, *parts: object) -> str:
    """Digest a bench on a model, the golden model, everything that they import, and `parts`.

    The name of the model's directory already has a digest of the Verilog and of the options of the build.
    """
    spec = importlib.util.find_spec(bench)
    assert spec and spec.origin, f"{bench} is no module"
    source = Path(spec.origin)
    packages = (Path(package.__path__[0]) for package in (raycaster, golden, sim, benches))
    return digest(model.directory.name, model.configuration, source, Path(random_scenes.__file__), *packages, *parts)


def _directory(share: Campaign) -> Path:
    return share.output / f"from{share.cases[0]}"


def _place(share: Campaign) -> Path:
    return _directory(share) / f"kept-{len(share.cases)}.pickle"


def _build(campaign: Campaign) -> Model:
    return build_model(campaign.configuration, campaign.simulator, build=campaign.build, flags=campaign.flags)


def run_share(share: Campaign) -> tuple[list[dict], str]:
    """Run one simulation and return its results, and its message if it failed."""
    directory = _directory(share).resolve()
    emptied(directory)  # a worker that died may have left files
    job = Job(
        share.configuration, output=str(directory), seeds=tuple(share.cases), stiff=share.stiff,
        registers=share.registers,
    )  # fmt: skip
    failure = ""
    try:
        run_bench(_build(share), share.bench, job, directory)
    except SimulationError as error:
        failure = str(error)
    results = directory / "results.jsonl"
    lines = results.read_text().splitlines() if results.exists() else []
    return [json.loads(line) for line in lines], failure
