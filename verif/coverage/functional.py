# SPDX-License-Identifier: MIT
"""Functional coverage: the kinds of intersection that an engine found, counted in cocotb-coverage's bins.

A probe in each unit counts the rectangles offered to its z buffer, or nearest hit, while the benches run. Rectangles
that culling ends early are not offered, so they are not counted. The beam engine's probe counts its testers' reports
for rays that exist.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
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

RAYS = "primary", "first", "second"
HITS = "edge", "hit"
Bin = tuple[str, ...]
Pattern = tuple[str | None, ...]
"""A bin in which None matches every value."""


@dataclass(frozen=True)
class Cross:
    """Points that are crossed."""

    name: str
    """Plural of the things that are counted, with underscores."""

    points: Mapping[str, Sequence[str]]
    """Bins of each point. The last three are a kind, its details, none at first, and the ray."""

    impossible: Mapping[str, Sequence[Pattern]]
    """Bins that nothing can hit, by reason."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of bins of each point."""
        return tuple(map(len, self.points.values()))

    def bins_at(self, place: Iterable[int]) -> Bin:
        """Return the bins at a place in an array of this shape."""
        return tuple(values[index] for values, index in zip(self.points.values(), place, strict=True))


def _points_of(engine: Engine) -> dict[str, tuple[str, ...]]:
    """Return the axis of a rectangle's plane, the slope of the ray on it, ..."""
    return {
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
        "ray": RAYS,
    }  # fmt: skip


def _impossible_in(engine: Engine) -> dict[str, tuple[Pattern, ...]]:
    points = _points_of(engine)
    results, ranks = points["result"], points["rank"]
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
INTERSECTIONS = {
    name: Cross("intersections", _points_of(engine), _impossible_in(engine)) for name, engine in ENGINES.items()
}
"""By engine, the intersections of a ray with a rectangle. With culling, no ray can hit the impossible bins."""

SHAPE = INTERSECTIONS[SEED.name].shape


class FunctionalCoverage:
    """Bins, empty at first. cocotb-coverage keeps one set per process, so a new object replaces the last one."""

    def __init__(self, cross: Cross = INTERSECTIONS[SEED.name]):
        """Declare the bins."""
        self.cross = cross
        coverage_db.clear()
        names = list(cross.points)
        points = [
            CoverPoint(f"raycaster.{name}", xf=lambda bins, place=place: bins[place], bins=list(cross.points[name]))
            for place, name in enumerate(names)
        ]
        crossed = CoverCross(
            self._name,
            items=[f"raycaster.{name}" for name in names],
            ign_bins=[pattern for patterns in cross.impossible.values() for pattern in patterns],
        )

        @coverage_section(*points, crossed)
        def sample(bins: Bin) -> None:
            pass

        self._sample: Callable[..., None] = sample

    def add(self, counts: np.ndarray) -> None:
        """Add to the bins.

        Args:
            counts: int64, with one axis per point, in order.

        Raises:
            ValueError: something is in a bin that was declared impossible.
        """
        for place in np.argwhere(counts):
            times = int(counts[tuple(place)])
            bins = self.cross.bins_at(place)
            if bins not in self.bins:
                raise ValueError(f"{', '.join(bins)}: declared impossible, but found {times} times")
            # cocotb-coverage counts one at a time; add the rest to its count.
            self._sample(bins)
            self.bins[bins] += times - 1
            for name, value in zip(self.cross.points, bins, strict=True):
                coverage_db[f"raycaster.{name}"].detailed_coverage[value] += times - 1

    @property
    def _name(self) -> str:
        return f"raycaster.{self.cross.name}"

    @property
    def bins(self) -> dict[Bin, int]:
        """Number of hits of each possible bin of the cross."""
        return coverage_db[self._name].detailed_coverage

    @property
    def holes(self) -> list[Bin]:
        """Bins that were not hit."""
        return [bins for bins, times in self.bins.items() if not times]

    @property
    def ignored(self) -> dict[str, int]:
        """Number of impossible bins of the cross, by reason; a bin with several reasons counts for the first."""
        found = dict.fromkeys(self.cross.impossible, 0)
        for place in np.ndindex(self.cross.shape):
            bins = self.cross.bins_at(place)
            for reason, patterns in self.cross.impossible.items():
                if any(all(want in (None, has) for want, has in zip(p, bins, strict=True)) for p in patterns):
                    found[reason] += 1
                    break
        return found

    def export(self, path: Path) -> None:
        """Write `path` with the suffixes .xml, in the format of cocotb-coverage, and .json."""
        coverage_db.export_to_xml(str(path.with_suffix(".xml")))
        cross = coverage_db[self._name]
        result = {
            "points": list(self.cross.points),
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
