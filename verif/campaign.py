# SPDX-License-Identifier: MIT
"""A long run of numbered cases through a bench, some per simulation, which an interrupted command resumes."""

from __future__ import annotations

import importlib.util
import json
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import raycaster
from raycaster import golden, sim
from raycaster.configuration import Configuration
from raycaster.digests import digest
from raycaster.jobs import Kept, run_jobs
from raycaster.output import Console, emptied
from raycaster.sim.job import Job
from raycaster.sim.simulator import VERILATOR_FLAGS, Model, SimulationError, build_model, convert, run_bench
from raycaster.verif import benches, random_scenes
from raycaster.waits import building


@dataclass(frozen=True)
class Campaign:
    """Cases, or some of them for one simulation.

    Attributes:
        bench: the module of its cocotb test, which takes the job's seeds for the cases' numbers and writes a line of
            JSON for each to `results.jsonl` in the job's output.
        configuration: the design.
        cases: their numbers.
        output: of all of them: `results.jsonl` is all results, `<digest>/from<number>` what a simulation wrote. The
            digest is of all that decides the results.
        build: the directory that holds `model/`.
        simulator: one of `SIMULATORS`.
        flags: for Verilator.
        probes: Verilog beside the design's.
        stiff: the job's.
        registers: the job's.
        share: cases of a simulation; 0 chooses.
        fresh: run simulations again that an earlier run of the command has completed.
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
    fresh: bool = False


@dataclass(frozen=True)
class Outcome:
    """What came of a campaign.

    Attributes:
        results: in the order of the cases.
        failures: what each failed simulation said.
        missing: how many cases have no result.
        seconds: that the simulations of this run took together.
        directories: what each simulation wrote.
    """

    results: list[dict]
    failures: list[str]
    missing: int
    seconds: float
    directories: list[Path]

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
    with console.waiting(f"building {campaign.configuration.name}", building(campaign.configuration.engine)):
        model = _build(campaign)  # which the workers find
    started = time.perf_counter()
    output = campaign.output / bench_digest(campaign.bench, model, campaign.stiff, dict(campaign.registers))
    cases = campaign.cases
    share = campaign.share or min(max(len(cases) // 20, 5), 20)  # starting one takes as long as showing a scene
    firsts = range(0, len(cases), share)
    shares = [replace(campaign, output=output, cases=cases[first : first + share]) for first in firsts]
    kept = Kept(_place, campaign.fresh, complete=lambda found: not found[1])
    found = run_jobs("simulations", run_share, shares, make_executor, console, kept=kept)
    results = [result for results, _ in found for result in results]
    (campaign.output / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results))
    failures = [failure for _, failure in found if failure]
    seconds = time.perf_counter() - started
    return Outcome(results, failures, len(cases) - len(results), seconds, [_directory(share) for share in shares])


def bench_digest(bench: str, model: Model, *parts: object) -> str:
    """A digest of a bench on a model, of the golden model, of what they import, and of anything else.

    The model's directory has a digest of its own, of the Verilog and how it was built.
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
