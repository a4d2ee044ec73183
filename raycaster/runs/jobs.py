# SPDX-License-Identifier: MIT
"""Run independent jobs with a progress bar, in local processes or on the workers of a Dask cluster.

Results can be kept, so that an interrupted command resumes with the jobs that are left.
"""

from __future__ import annotations

import argparse
import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from raycaster.errors import UserError, not_installed
from raycaster.output import Console

ATTEMPTS = 3
"""Number of attempts at a job whose worker in a Dask cluster dies."""

J = TypeVar("J")
R = TypeVar("R")


def positive(text: str, least: int = 1) -> int:
    """Parse an option's number, 1 or more."""
    value = int(text)
    if value < least:
        raise ValueError
    return value


def natural(text: str) -> int:
    """Parse an option's number, 0 or more."""
    return positive(text, 0)


def add_job_options(parser: argparse.ArgumentParser, jobs: int = 2) -> None:
    """Add `--jobs` and `--scheduler`, the arguments of `executors`."""
    help_of_jobs = "local processes at a time (default: %(default)s)"
    parser.add_argument("--jobs", type=positive, default=jobs, metavar="N", help=help_of_jobs)
    parser.add_argument(
        "--scheduler", metavar="ADDRESS",
        help="Dask scheduler, such as tcp://host:8786, whose workers see this directory (default: local processes)",
    )  # fmt: skip


def add_fresh_option(parser: argparse.ArgumentParser) -> None:
    """Add `--fresh`, for a command whose results are `Kept`."""
    parser.add_argument("--fresh", action="store_true", help="ignore results kept by an earlier run")


@dataclass(frozen=True)
class Kept:
    """Files that keep the results of jobs from one run of a command to the next.

    Attributes:
        place: returns the file of a job's result; its path contains a digest of everything that affects the result.
        fresh: overwrite the files without reading them.
        complete: returns whether to keep a result; failures, for example, are worth another try.
    """

    place: Callable[[Any], Path]
    fresh: bool = False
    complete: Callable[[Any], bool] = lambda result: True

    def find(self, job: object) -> tuple[bool, Any]:
        """Return whether a job's result is kept, and the result."""
        try:
            return (False, None) if self.fresh else (True, pickle.loads(self.place(job).read_bytes()))
        except FileNotFoundError:
            return False, None

    def store(self, job: object, result: object) -> None:
        """Keep a result if it is complete."""
        if self.complete(result):
            place = self.place(job)
            place.parent.mkdir(parents=True, exist_ok=True)
            partial = place.with_suffix(".partial")
            partial.write_bytes(pickle.dumps(result))
            partial.replace(place)


def processes(jobs: int, *, spawned: bool = False) -> Callable[[], Executor]:
    """Return a function that makes executors of local processes, which are forked unless they must be `spawned`."""
    return partial(ProcessPoolExecutor, jobs, mp_context=get_context("spawn") if spawned else None)


def threads(jobs: int) -> Callable[[], Executor]:
    """Return a function that makes executors of threads, for jobs that wait for other programs."""
    return partial(ThreadPoolExecutor, jobs)


@contextmanager
def executors(scheduler: str | None, jobs: int) -> Iterator[Callable[[], Executor]]:
    """Yield a function that makes executors, for local processes or for the workers of a Dask cluster.

    Args:
        scheduler: address of the cluster's scheduler, such as tcp://host:8786; None for local processes.
        jobs: number of local processes.

    Raises:
        UserError: Dask is missing, or no scheduler answers at the address.
    """
    if scheduler is None:
        yield processes(jobs)
        return
    try:
        from distributed import Client  # noqa: PLC0415 - needed only with a cluster
    except ImportError:
        raise UserError(not_installed("Dask", "report")) from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise UserError(f"scheduler: no Dask scheduler answers at {scheduler}: {error}") from None
    with client:
        yield lambda: client.get_executor(pure=False, retries=ATTEMPTS)


def run_jobs(
    what: str,
    function: Callable[[J], R],
    jobs: Sequence[J],
    make_executor: Callable[[], Executor],
    console: Console,
    *,
    finished: Callable[[J, R], object] = lambda job, result: None,
    kept: Kept | None = None,
) -> list[R]:
    """Run a function on every job, and return the results in the order of the jobs.

    Args:
        what: name of the jobs on the progress bar.
        function: function that a worker can import; its argument and result must be picklable.
        jobs: arguments of the function.
        make_executor: function that `executors` yields, or that `processes` or `threads` returns.
        console: console for the progress bar.
        finished: called locally with each job and its result as soon as it arrives.
        kept: results of earlier runs, to which new ones are added.

    Raises:
        UserError: a local worker died.
    """
    found: list[tuple[bool, Any]] = [kept.find(job) if kept else (False, None) for job in jobs]
    results: dict[int, R] = {place: result for place, (there, result) in enumerate(found) if there}
    if results:
        console.print(f"already there: {len(results)} of {len(jobs)} {what}")
    missing = [place for place in range(len(jobs)) if place not in results]
    if not missing:
        return [results[place] for place in range(len(jobs))]
    columns = TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn()
    with (
        Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress,
        make_executor() as pool,
    ):
        task = progress.add_task("", total=len(jobs), completed=len(results))
        futures = {}
        try:
            futures = {pool.submit(function, jobs[place]): place for place in missing}
            for future in as_completed(futures):
                place = futures[future]
                results[place] = future.result()
                if kept:
                    kept.store(jobs[place], results[place])
                finished(jobs[place], results[place])
                progress.advance(task)
        except BrokenExecutor:
            raise UserError(f"{what}: a worker was killed, maybe for lack of memory; use fewer jobs") from None
        finally:
            # Jobs that have not started must not delay an error or the prompt.
            for future in futures:
                future.cancel()
    return [results[place] for place in range(len(jobs))]
