# SPDX-License-Identifier: MIT
"""Sweep over points: an executor computes them, and each result is kept at once, so nothing is computed twice."""

from __future__ import annotations

import resource
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import Any

from raycaster.jobs import Kept, run_jobs
from raycaster.output import Console
from raycaster.report.points import Point


@dataclass(frozen=True)
class Sweep:
    """Computes points, except those whose results are kept.

    Attributes:
        directory: directory of results, one atomically written file per point.
        make_executor: function that `raycaster.jobs.executors` yields.
        console: console for the progress bars.
    """

    directory: Path
    make_executor: Callable[[], Executor]
    console: Console
    _seconds: dict[Point, float] = field(default_factory=dict)

    def __call__(self, what: str, points: Sequence[Point]) -> dict[Point, dict[str, Any]]:
        """Return all results in the order of the points, computing only those that are not kept.

        Args:
            what: name of the points on the progress bar.
            points: points to compute; each new result is kept as soon as it is computed.

        Raises:
            UserError: workers died repeatedly on the same points.
        """
        points = list(dict.fromkeys(points))
        label = attrgetter("arguments")
        found = run_jobs(what, timed, points, self.make_executor, self.console, label=label, kept=Kept(self.place))
        self._seconds.update((point, seconds) for point, (_, seconds) in zip(points, found, strict=True))
        return {point: result for point, (result, _) in zip(points, found, strict=True)}

    def place(self, point: Point) -> Path:
        """Return the file of a point's result, whose name changes with everything that the result depends on."""
        return self.directory / point.kind / point.fingerprint

    def spent(self) -> dict[str, tuple[int, float]]:
        """Return the number of points and the processor seconds that they took, kept results included, by kind."""
        kinds: dict[str, list[float]] = {}
        for point, seconds in self._seconds.items():
            kinds.setdefault(point.kind, []).append(seconds)
        return {kind: (len(seconds), sum(seconds)) for kind, seconds in kinds.items()}


def timed(point: Point) -> tuple[dict[str, Any], float]:
    """Compute a point; return its result, and the seconds that this process and the programs it called computed."""
    before = _computed()
    return point.compute(), _computed() - before


def _computed() -> float:
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)
