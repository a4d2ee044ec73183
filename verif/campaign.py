# SPDX-License-Identifier: MIT
"""A long run of numbered cases through a bench, some to a simulation, so that little is lost with a worker."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

from raycaster.configuration import Configuration
from raycaster.jobs import run_jobs
from raycaster.output import Console, emptied
from raycaster.sim.job import Job
from raycaster.sim.simulator import VERILATOR_FLAGS, Model, SimulationError, build_model, convert, run_bench


@dataclass(frozen=True)
class Campaign:
    """Cases, or some of them for one simulation.

    Attributes:
        bench: the module of its cocotb test, which takes the job's seeds for the cases' numbers and writes a line of
            JSON for each to `results.jsonl` in the job's output.
        configuration: the design.
        cases: their numbers.
        output: of all of them; replaced: `results.jsonl` is all results, `from<number>` what a simulation wrote.
        build: the directory that holds `model/`.
        simulator: one of `SIMULATORS`.
        flags: for Verilator.
        probes: Verilog beside the design's.
        stiff: the job's.
        registers: the job's.
        share: cases of a simulation; 0 chooses.
    """

    bench: str
    configuration: Configuration
    cases: range
    output: Path
    build: Path
    simulator: str = "verilator"
    flags: Sequence[str] = VERILATOR_FLAGS
    probes: Sequence[Path] = ()
    stiff: bool = False
    registers: Mapping[str, Sequence[str]] = field(default_factory=dict)
    share: int = 0


@dataclass(frozen=True)
class Outcome:
    """What came of a campaign.

    Attributes:
        results: in the order of the cases.
        failures: what each failed simulation said.
        missing: how many cases have no result.
        seconds: that the simulations took together.
    """

    results: list[dict]
    failures: list[str]
    missing: int
    seconds: float

    def verdict(self, cases: str, console: Console) -> int:
        """Print what failed, and how many cases, as they are called, have no result; the command's exit code."""
        for failure in self.failures:
            console.print(failure, style="red", soft_wrap=True)
        if self.missing:
            console.print(f"{self.missing} {cases} have no result", style="red")
        return int(bool(self.failures or self.missing))


def run_campaign(
    campaign: Campaign, console: Console, make_executor: Callable[[], Executor] = ProcessPoolExecutor
) -> Outcome:
    """Run all cases.

    Args:
        campaign: they.
        console: for the progress bar.
        make_executor: see `raycaster.jobs.executors`.

    Raises:
        UserError: a tool is missing.
        SimulationError: the model cannot be built.
    """
    with console.status(f"building {campaign.configuration.name}"):
        _build(campaign)  # which the workers find
    started = time.perf_counter()
    emptied(campaign.output)
    cases = campaign.cases
    share = campaign.share or min(max(len(cases) // 20, 5), 20)  # starting one takes as long as showing a scene
    shares = [replace(campaign, cases=cases[first : first + share]) for first in range(0, len(cases), share)]
    found = run_jobs("simulations", run_share, shares, make_executor, console)
    results = [result for results, _ in found for result in results]
    (campaign.output / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results))
    failures = [failure for _, failure in found if failure]
    return Outcome(results, failures, len(cases) - len(results), time.perf_counter() - started)


def _build(campaign: Campaign) -> Model:
    verilog = [*convert(campaign.configuration, campaign.build), *campaign.probes]
    return build_model(
        campaign.configuration, campaign.simulator, build=campaign.build, verilog=verilog, flags=campaign.flags
    )


def run_share(share: Campaign) -> tuple[list[dict], str]:
    """The results of one simulation, and what it said if it failed."""
    directory = (share.output / f"from{share.cases[0]}").resolve()
    emptied(directory)  # a worker that died may have begun it
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
