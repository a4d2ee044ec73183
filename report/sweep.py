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
from typing import Any

from raycaster.jobs import run_jobs
from raycaster.output import Console
from raycaster.report.points import Point


@dataclass(frozen=True)
class Sweep:
    """Computes points, except those whose results are stored.

    Attributes:
        directory: directory of results, one atomically written file per point.
        make_executor: function that `raycaster.jobs.executors` yields.
        console: console for the progress bars.
    """

    directory: Path
    make_executor: Callable[[], Executor]
    console: Console

    def __call__(self, what: str, points: Sequence[Point]) -> dict[Point, dict[str, Any]]:
        """Return all results in the order of the points, computing only those that are not stored.

        Args:
            what: name of the points on the progress bar.
            points: points to compute; each new result is stored as soon as it is computed.

        Raises:
            UserError: workers died repeatedly on the same points.
        """
        results = {point: result for point in points if (result := self.find(point)) is not None}

        def keep(point: Point, result: dict[str, Any]) -> None:
            self.keep(point, result)
            results[point] = result

        missing = [point for point in dict.fromkeys(points) if point not in results]
        run_jobs(
            what, methodcaller("compute"), missing, self.make_executor, self.console, finished=keep,
            before=len(results), label=attrgetter("arguments"),
        )  # fmt: skip
        return {point: results[point] for point in points}

    def find(self, point: Point) -> dict[str, Any] | None:
        """Return the stored result; None if there is none or something that it depends on has changed."""
        try:
            stored = json.loads(self._path(point).read_text())
        except (OSError, ValueError):
            return None
        return stored["result"] if stored.get("fingerprint") == point.fingerprint else None

    def keep(self, point: Point, result: dict[str, Any]) -> None:
        """Store a result."""
        stored = {"fingerprint": point.fingerprint, "command": point.command, "result": result}
        self.directory.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=self.directory, prefix=".", suffix=".json")
        with os.fdopen(handle, "w") as file:
            json.dump(stored, file, indent=1)
        Path(name).replace(self._path(point))

    def _path(self, point: Point) -> Path:
        name = re.sub(r"[^\w.]+", "-", point.arguments)
        return self.directory / f"{name}.json"
