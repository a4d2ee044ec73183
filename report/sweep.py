# SPDX-License-Identifier: MIT
"""Sweep over points: an executor computes them, and each result is stored at once, so nothing is computed twice."""

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
    """Directory of results, one atomically written file per point."""

    def __init__(self, directory: Path):
        self._directory = directory
        directory.mkdir(parents=True, exist_ok=True)

    def find(self, point: Point) -> dict[str, Any] | None:
        """Return the stored result; None if there is none or something that it depends on has changed."""
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
    """Computes points, except those whose results are stored."""

    store: Store
    make_executor: Callable[[], Executor]
    console: Console

    def __call__(self, what: str, points: Sequence[P]) -> dict[P, dict[str, Any]]:
        """Compute points; see `run`."""
        return run(what, points, self.store, self.make_executor, self.console)


def run(
    what: str, points: Sequence[P], store: Store, make_executor: Callable[[], Executor], console: Console
) -> dict[P, dict[str, Any]]:
    """Return all results in the order of the points, computing only those that are not stored.

    Args:
        what: name of the points on the progress bar.
        points: points to compute.
        store: store of results; each new one is added as soon as it is computed.
        make_executor: function that `raycaster.jobs.executors` yields.
        console: console for the progress bar.

    Raises:
        UserError: workers died repeatedly on the same points.
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
