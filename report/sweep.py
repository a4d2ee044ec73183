# SPDX-License-Identifier: MIT
"""A sweep over points: run through an executor, each point stored as it finishes, so that nothing is done twice."""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from raycaster.errors import UserError, not_installed
from raycaster.report.points import Point, command, fingerprint

ATTEMPTS = 3
"""Times that a point is tried whose worker died."""

P = TypeVar("P", bound=Point)


class Store:
    """Results in a directory, a file a point, each written as a whole."""

    def __init__(self, directory: Path):
        self._directory = directory
        directory.mkdir(parents=True, exist_ok=True)

    def find(self, point: Point) -> dict[str, Any] | None:
        """The result, if it was stored and nothing that it depends on has changed."""
        try:
            stored = json.loads(self._path(point).read_text())
        except (OSError, ValueError):
            return None
        return stored["result"] if stored.get("fingerprint") == fingerprint(point) else None

    def keep(self, point: Point, result: dict[str, Any]) -> None:
        """Store a result."""
        text = json.dumps({"fingerprint": fingerprint(point), "command": command(point), "result": result}, indent=1)
        handle, name = tempfile.mkstemp(dir=self._directory, prefix=".", suffix=".json")
        with os.fdopen(handle, "w") as file:
            file.write(text)
        Path(name).replace(self._path(point))

    def _path(self, point: Point) -> Path:
        name = re.sub(r"[^\w.]+", "-", point.arguments)
        return self._directory / f"{name}.json"


@contextmanager
def executor(scheduler: str | None, jobs: int) -> Iterator[Callable[[], Executor]]:
    """Something that makes executors: of processes here, or of a Dask cluster's workers.

    Args:
        scheduler: address of the cluster's scheduler, such as tcp://host:8786; None for processes here.
        jobs: how many of these.

    Raises:
        UserError: Dask is missing, or no scheduler answers there.
    """
    if scheduler is None:
        yield lambda: ProcessPoolExecutor(jobs)
        return
    try:
        from distributed import Client  # noqa: PLC0415 - wanted only where a cluster is
    except ImportError:
        raise UserError(not_installed("Dask", "report")) from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise UserError(f"scheduler: no Dask scheduler answers at {scheduler}: {error}") from None
    with client:
        yield lambda: client.get_executor(pure=False, retries=ATTEMPTS)


def run(
    what: str, points: Sequence[P], store: Store, make_executor: Callable[[], Executor], console: Console
) -> dict[P, dict[str, Any]]:
    """All results, in the order of the points; those that the store has are not computed again.

    Args:
        what: the points are, for the progress bar.
        points: to find out.
        store: where results are looked for and kept, each as soon as it is there.
        make_executor: as `executor` yields it.
        console: for the progress bar.

    Raises:
        UserError: workers died on the same points `ATTEMPTS` times.
    """
    results = {point: result for point in points if (result := store.find(point)) is not None}
    columns = TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn()
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=len(points), completed=len(results))
        for _ in range(ATTEMPTS):
            missing = [point for point in points if point not in results]
            if not missing:
                break
            with make_executor() as pool:
                futures: dict[Future, P] = {pool.submit(point.compute): point for point in missing}
                try:
                    for future in as_completed(futures):
                        try:
                            result = future.result()
                        except BrokenProcessPool:
                            continue  # a worker died, and took the others' work with it: once more
                        store.keep(futures[future], result)
                        results[futures[future]] = result
                        progress.advance(task)
                except BaseException:
                    # What did not start yet shall not keep one from the error, or from the prompt.
                    for future in futures:
                        future.cancel()
                    raise
    if missing := [point for point in points if point not in results]:
        raise UserError(f"workers died {ATTEMPTS} times on {len(missing)} points, {missing[0].arguments} among them")
    return {point: results[point] for point in points}
