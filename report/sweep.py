# SPDX-License-Identifier: MIT
"""A sweep over points: run through an executor, each point stored as it finishes, so that nothing is done twice."""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from operator import attrgetter, methodcaller
from pathlib import Path
from typing import Any, TypeVar

from raycaster.jobs import run_jobs
from raycaster.output import Console
from raycaster.report.points import Point, command, fingerprint

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


@dataclass(frozen=True)
class Sweep:
    """Finds points out, those that were stored before excepted."""

    store: Store
    make_executor: Callable[[], Executor]
    console: Console

    def __call__(self, what: str, points: Sequence[P]) -> dict[P, dict[str, Any]]:
        """As `run`."""
        return run(what, points, self.store, self.make_executor, self.console)


def run(
    what: str, points: Sequence[P], store: Store, make_executor: Callable[[], Executor], console: Console
) -> dict[P, dict[str, Any]]:
    """All results, in the order of the points; those that the store has are not computed again.

    Args:
        what: the points are, for the progress bar.
        points: to find out.
        store: where results are looked for and kept, each as soon as it is there.
        make_executor: as `raycaster.jobs.executors` yields it.
        console: for the progress bar.

    Raises:
        UserError: workers died on the same points again and again.
    """
    results = {point: result for point in points if (result := store.find(point)) is not None}

    def keep(point: P, result: dict[str, Any]) -> None:
        store.keep(point, result)
        results[point] = result

    missing = [point for point in points if point not in results]
    run_jobs(
        what, methodcaller("compute"), missing, make_executor, console, finished=keep, before=len(results),
        label=attrgetter("arguments"),
    )  # fmt: skip
    return {point: results[point] for point in points}
