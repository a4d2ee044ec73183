# SPDX-License-Identifier: MIT
"""Jobs: workers that die lose no job, and an interrupted command does not compute finished jobs again."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from operator import methodcaller
from pathlib import Path

import pytest
from distributed import LocalCluster
from rich.console import Console

from raycaster.digests import digest
from raycaster.errors import UserError
from raycaster.jobs import Kept, executors, processes, run_jobs, threads


@pytest.fixture
def squares(tmp_path):
    """Return a function that squares numbers, checks the results, and returns the numbers it computed."""

    def run(numbers, **options):
        computed = []

        def square(number):
            computed.append(number)
            return number**2

        kept = Kept(lambda number: tmp_path / f"{number}.pickle", **options)
        results = run_jobs("squares", square, numbers, threads(1), Console(), kept=kept)
        assert results == [number**2 for number in numbers]
        return computed

    return run


def test_kept_results_are_not_computed_again(squares, capsys):
    assert squares([1, 2]) == [1, 2]
    assert squares([0, 1, 2, 3]) == [0, 3]
    assert "already there: 2 of 4 squares" in capsys.readouterr().out
    assert squares([0, 1, 2, 3], fresh=True) == [0, 1, 2, 3]


def test_a_failure_is_retried(squares):
    for computed in ([2, 3], [3]):
        assert squares([2, 3], complete=lambda result: result % 2 == 0) == computed


def test_a_result_cut_off_is_computed_again(squares, tmp_path: Path):
    squares([5])
    whole = (tmp_path / "5.pickle").read_bytes()
    for cut in range(len(whole)):
        (tmp_path / "5.pickle").write_bytes(whole[:cut])
        assert squares([5]) == [5]


def test_a_digest_covers_values_and_contents(tmp_path: Path):
    (tmp_path / "a.v").write_text("module a;")
    before = digest("x", 1, tmp_path), digest(tmp_path / "a.v")
    assert digest("x", 2, tmp_path) != before[0]
    assert digest("x1", tmp_path) != digest("x", 1, tmp_path) == before[0]
    (tmp_path / "b.v").write_text("module b;")
    assert digest("x", 1, tmp_path) != before[0]
    assert digest(tmp_path / "a.v") == before[1]


TWO = processes(2)


@dataclass(frozen=True)
class Task:
    """A number to square; leaves a mark in a directory each time, and kills its worker as often as it says."""

    directory: Path
    number: int
    deaths: int = 0
    fails_after: Path | None = None
    """File for which it waits before it fails."""

    def marks(self) -> int:
        return len(list(self.directory.glob(f"mark-{self.number}-*")))

    def square(self) -> int:
        last = self.marks() >= self.deaths
        (self.directory / f"mark-{self.number}-{time.monotonic_ns()}").touch()
        if not last:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.fails_after:
            wait_for(self.fails_after.exists)
            raise UserError("this cannot be")
        time.sleep(0.05)
        return self.number**2


def wait_for(happened: Callable[[], bool]) -> None:
    """Wait, a minute at most, until something has happened in another process."""
    deadline = time.monotonic() + 60
    while not happened():
        assert time.monotonic() < deadline, "it has not happened in a minute"
        time.sleep(0.01)


def run(tasks, make_executor=TWO, **options) -> list[int]:
    label = "task {0.number}".format
    return run_jobs("", methodcaller("square"), tasks, make_executor, Console(quiet=True), label=label, **options)


def test_a_killed_worker_does_not_lose_its_job(tmp_path):
    tasks = [*(Task(tmp_path, number) for number in range(7)), Task(tmp_path, 7, deaths=1)]
    assert run(tasks) == [number**2 for number in range(8)]
    assert tasks[7].marks() == 2
    with pytest.raises(UserError, match=r"^workers died 3 times on 1 jobs, task 8 among them$"):
        run([Task(tmp_path, 8, deaths=9)])


def test_an_error_ends_the_run_and_keeps_what_was_found(tmp_path):
    """Each result is kept at once, so the run may end in any way; the next one computes only what is missing."""
    tasks = [Task(tmp_path, number) for number in range(30)]
    kept = Kept(lambda task: tmp_path / f"{task.number}.pickle")
    failing = [tasks[0], Task(tmp_path, 30, fails_after=kept.place(tasks[0])), *tasks[1:]]
    with pytest.raises(UserError, match=r"^this cannot be$"):
        run(failing, processes(1), kept=kept)
    found = [task for task in tasks if kept.find(task)[0]]
    assert 1 <= len(found) < 20 and tasks[0] in found
    # Jobs that had not started did not delay the error.
    assert sum(task.marks() for task in tasks) < 20
    assert run(tasks, kept=kept) == [task.number**2 for task in tasks]
    assert all(task.marks() == 1 for task in found)


def test_a_dask_cluster_whose_worker_is_killed(tmp_path):
    workers = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "local_directory": str(tmp_path)}
    with LocalCluster(**workers) as cluster, executors(cluster.scheduler_address, 1) as make_executor:

        def processes_of_workers() -> set[int | None]:
            return {worker.pid for worker in cluster.workers.values()}

        first = processes_of_workers()
        tasks = [Task(tmp_path, number, deaths=int(number == 2)) for number in range(12)]
        assert run(tasks, make_executor) == [number**2 for number in range(12)]
        assert tasks[2].marks() >= 2
        # The cluster replaces the worker that died.
        wait_for(lambda: processes_of_workers() != first)


@pytest.mark.parametrize("scheduler", ["nowhere", pytest.param("tcp://127.0.0.1:1", marks=pytest.mark.slow)])
def test_a_scheduler_that_does_not_answer(tmp_path, scheduler):
    """In a separate process, which ends what Dask starts."""
    call = [sys.executable, "-m", "raycaster.cli", "report", "--scheduler", scheduler]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert re.fullmatch(rf"error: scheduler: no Dask scheduler answers at {scheduler}.*\n", done.stderr)
