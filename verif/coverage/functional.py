# SPDX-License-Identifier: MIT
"""Functional coverage: the kinds of intersection that an engine found, counted in cocotb-coverage's bins.

A probe in each unit counts the rectangles offered to its z buffer, or nearest hit, while the benches run. Rectangles
that culling ends early are not offered, so they are not counted. The beam engine's probe counts its testers' reports
for rays that exist.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from cocotb_coverage.coverage import CoverCross, CoverPoint, coverage_db, coverage_section

from raycaster.engines import ENGINES, SEED, Engine

HERE = Path(__file__).parent
COUNTER = HERE / "intersection_counter.v"
PROBES = {
    name: (*((COUNTER,) if engine.line_buffered else ()), HERE / f"{name}_probe.v") for name, engine in ENGINES.items()
}
"""By engine, Verilog that is added to the design and writes the files that `read_bins` reads."""

PROBE_MODULES = "intersection_counter", "intersection_probe", "pass_probe", "tester_probe"

POINTS = {
    name: {
        "axis": ("x", "y", "z"),
        "slope": ("negative", "zero", "positive"),
        # In order of precedence: parallel to the plane; from a point on it; running away from it; in the seed engine,
        # a quotient on u or v that is too large; in the exact engine, between the mirrored eye and the mirror, or in
        # the mirror's plane on an axis that was met there, though within the bounds; outside the bounds; exactly on a
        # bound; inside.
        "result": (
            "parallel", "on plane", "behind", "overflow" if engine.divides else "before mirror", "miss", "edge", "hit",
        ),
        # How a hit ranks.
        "rank": ("none", "first", "nearer", "tie", "farther"),
        "ray": ("primary", "first", "second"),
    }
    for name, engine in ENGINES.items()
}  # fmt: skip
"""By engine, the points that are crossed, and their bins: axis of the rectangle's plane, slope of the ray on it, ..."""

SHAPE = tuple(map(len, POINTS[SEED.name].values()))
CROSS = "raycaster.intersection"
HITS = ("edge", "hit")
Bin = tuple[str, str, str, str, str]
Pattern = tuple[str | None, str | None, str | None, str | None, str | None]
"""A bin in which None matches every value."""


def _impossible_in(engine: Engine) -> dict[str, tuple[Pattern, ...]]:
    """Return the bins that no ray can hit, by reason."""
    results, ranks = POINTS[engine.name]["result"], POINTS[engine.name]["rank"]
    return {
        "a ray without a slope along the axis of a plane never reaches it": tuple(
            (None, "zero", result, None, None) for result in results if result != "parallel"
        ),
        "a ray with a slope along the axis of a plane is not parallel to it": (
            (None, "negative", "parallel", None, None),
            (None, "positive", "parallel", None, None),
        ),
        "every hit is ranked": tuple((None, None, result, "none", None) for result in HITS),
        "only hits are ranked": tuple(
            (None, None, result, rank, None)
            for result in results
            if result not in HITS
            for rank in ranks
            if rank != "none"
        ),
        "the slope along x has magnitude 100, never 0": (("x", "zero", None, None, None),),
        "primary rays run along positive x": (("x", "negative", None, None, "primary"),),
        **(_GIVEN_UP if engine.divides else _WITHOUT_MIRROR),
    }


# A control that waits for divisions skips a rectangle that no ray of the group runs towards.
_GIVEN_UP: dict[str, tuple[Pattern, ...]] = {
    "a group's primary rays run the same way from one point; a plane that none runs towards is skipped": (
        (None, None, "on plane", None, "primary"),
        (None, None, "behind", None, "primary"),
    ),
    "all rays of a group have the row's slope along z, so a plane that they are parallel to is skipped": (
        ("z", None, "parallel", None, None),
    ),
}
_WITHOUT_MIRROR: dict[str, tuple[Pattern, ...]] = {
    "primary rays have left no mirror": ((None, None, "before mirror", None, "primary"),),
}
IMPOSSIBLE = {name: _impossible_in(engine) for name, engine in ENGINES.items()}
"""By engine, bins that no ray can hit with culling, by reason."""


class FunctionalCoverage:
    """Bins, empty at first. cocotb-coverage keeps one set per process, so a new object replaces the last one."""

    def __init__(self, engine: str = SEED.name):
        """Declare the bins.

        Args:
            engine: one of `POINTS`.
        """
        self.points, self._impossible = POINTS[engine], IMPOSSIBLE[engine]
        coverage_db.clear()
        names = list(self.points)
        points = [CoverPoint(f"raycaster.{name}", vname=name, bins=list(self.points[name])) for name in names]
        cross = CoverCross(
            CROSS,
            items=[f"raycaster.{name}" for name in names],
            ign_bins=[pattern for patterns in self._impossible.values() for pattern in patterns],
        )

        @coverage_section(*points, cross)
        def sample(axis: str, slope: str, result: str, rank: str, ray: str) -> None:
            pass

        self._sample: Callable[..., None] = sample

    def add(self, counts: np.ndarray) -> None:
        """Add to the bins.

        Args:
            counts: as `read_bins` returns them.

        Raises:
            ValueError: an intersection is in a bin that was declared impossible.
        """
        for place in np.argwhere(counts):
            times = int(counts[tuple(place)])
            bins = tuple(values[index] for values, index in zip(self.points.values(), place, strict=True))
            if bins not in self.bins:
                raise ValueError(f"{', '.join(bins)}: declared impossible, but found {times} times")
            # cocotb-coverage counts one at a time; add the rest to its count.
            self._sample(*bins)
            self.bins[bins] += times - 1
            for name, value in zip(self.points, bins, strict=True):
                coverage_db[f"raycaster.{name}"].detailed_coverage[value] += times - 1

    @property
    def bins(self) -> dict[Bin, int]:
        """Number of hits of each possible bin of the cross."""
        return coverage_db[CROSS].detailed_coverage

    @property
    def holes(self) -> list[Bin]:
        """Bins that were not hit."""
        return [bins for bins, times in self.bins.items() if not times]

    @property
    def ignored(self) -> dict[str, int]:
        """Number of impossible bins of the cross, by reason; a bin with several reasons counts for the first."""
        found = dict.fromkeys(self._impossible, 0)
        for place in np.ndindex(SHAPE):
            bins = [values[index] for values, index in zip(self.points.values(), place, strict=True)]
            for reason, patterns in self._impossible.items():
                if any(all(want in (None, has) for want, has in zip(p, bins, strict=True)) for p in patterns):
                    found[reason] += 1
                    break
        return found

    def export(self, path: Path) -> None:
        """Write `path` with the suffixes .xml, in the format of cocotb-coverage, and .json."""
        coverage_db.export_to_xml(str(path.with_suffix(".xml")))
        cross = coverage_db[CROSS]
        result = {
            "points": list(self.points),
            "covered": cross.coverage,
            "bins": cross.size,
            "ignored": self.ignored,
            "hits": [[*bins, times] for bins, times in self.bins.items()],
        }
        path.with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n")


def read_bins(directory: Path) -> np.ndarray:
    """Read the counts of all probes of a simulation, summed over its frames.

    Args:
        directory: the one in which the simulation ran.

    Returns:
        int64, with one axis per point, in order.
    """
    counts = np.zeros(np.prod(SHAPE), dtype=np.int64)
    for path in directory.glob("bins.*"):
        place, times = np.array(path.read_text().split(), dtype=np.int64).reshape(-1, 2).T
        np.add.at(counts, place, times)
    return counts.reshape(SHAPE)
