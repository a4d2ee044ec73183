# SPDX-License-Identifier: MIT
"""Jobs: a cluster's worker that is killed loses none, and an interrupted command does not repeat finished ones."""

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

from raycaster.errors import UserError
from raycaster.runs.jobs import Kept, executors, processes, run_jobs


@dataclass(frozen=True)
class Task:
    """A number to square; leaves a mark in a directory each time, and kills its worker as often as it says."""

    directory: Path
    number: int
    deaths: int = 0

    def marks(self) -> int:
        return len(list(self.directory.glob(f"mark-{self.number}-*")))

    def square(self) -> int:
        last = self.marks() >= self.deaths
        (self.directory / f"mark-{self.number}-{time.monotonic_ns()}").touch()
        if not last:
            os.kill(os.getpid(), signal.SIGKILL)
        return self.number**2


ONE = processes(1)


def run(tasks: list[Task], make_executor=ONE, **options) -> list[int]:
    return run_jobs("", methodcaller("square"), tasks, make_executor, Console(quiet=True), **options)


def test_an_interrupted_run_is_resumed(tmp_path):
    """Each result is kept at once; the next run computes only what is missing."""

    def interrupt(task: Task, result: int) -> None:
        if task.number == 9:
            raise KeyboardInterrupt

    tasks = [Task(tmp_path, number) for number in range(500)]
    kept = Kept(lambda task: tmp_path / f"{task.number}.pickle")
    with pytest.raises(KeyboardInterrupt):
        run(tasks, kept=kept, finished=interrupt)
    found = [task for task in tasks if kept.find(task)[0]]
    assert tasks[9] in found and len(found) < 400
    assert run(tasks, kept=kept) == [task.number**2 for task in tasks]
    assert all(task.marks() == 1 for task in found)


def test_a_killed_worker_is_one_line(tmp_path):
    with pytest.raises(UserError, match=r"^: a worker was killed, maybe for lack of memory; use fewer jobs$"):
        run([Task(tmp_path, 1, deaths=1)])


def wait_for(happened: Callable[[], bool]) -> None:
    """Wait, a minute at most, until something has happened in another process."""
    deadline = time.monotonic() + 60
    while not happened():
        assert time.monotonic() < deadline, "it has not happened in a minute"
        time.sleep(0.01)


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


def test_a_scheduler_that_does_not_answer(tmp_path):
    """In a separate process, which ends what Dask starts."""
    call = [sys.executable, "-m", "raycaster.cli", "report", "--scheduler", "nowhere"]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert re.fullmatch(r"error: scheduler: no Dask scheduler answers at nowhere.*\n", done.stderr)
