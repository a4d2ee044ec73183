# SPDX-License-Identifier: MIT
"""Functional coverage: which kinds of intersection an engine found, counted in cocotb-coverage's bins.

A probe in each unit counts what is offered to its z buffer, or nearest hit, while the benches run. What culling gives
up early is not offered, and not counted. The beam engine's probe counts what its testers report of rays that there are.
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
"""By engine, Verilog beside the design's, which writes what `read_bins` reads."""

PROBE_MODULES = "intersection_counter", "intersection_probe", "pass_probe", "tester_probe"

POINTS = {
    name: {
        "axis": ("x", "y", "z"),
        "slope": ("negative", "zero", "positive"),
        # In this order of precedence: parallel to the plane, from a point on it, running away from it; of the seed
        # engine a quotient on u or v that is too large, of the exact engine between the mirrored eye and the mirror, or
        # on an axis that was met there, else a hit; outside the bounds, exactly on one of them, inside.
        "result": (
            "parallel", "on plane", "behind", "overflow" if engine.divides else "before mirror", "miss", "edge", "hit",
        ),
        # What is made of a hit.
        "rank": ("none", "first", "nearer", "tie", "farther"),
        "ray": ("primary", "first", "second"),
    }
    for name, engine in ENGINES.items()
}  # fmt: skip
"""By engine, the points that are crossed, and the bins of each: of the rectangle's plane, of the ray along it, ..."""

SHAPE = tuple(map(len, POINTS[SEED.name].values()))
CROSS = "raycaster.intersection"
HITS = ("edge", "hit")
Bin = tuple[str, str, str, str, str]
Pattern = tuple[str | None, str | None, str | None, str | None, str | None]
"""A bin, where None stands for every value."""


def _impossible_in(engine: Engine) -> dict[str, tuple[Pattern, ...]]:
    """Bins that no ray can hit, by the reason."""
    results, ranks = POINTS[engine.name]["result"], POINTS[engine.name]["rank"]
    return {
        "without a slope along its axis a plane is never reached": tuple(
            (None, "zero", result, None, None) for result in results if result != "parallel"
        ),
        "with a slope along its axis a ray is not parallel to a plane": (
            (None, "negative", "parallel", None, None),
            (None, "positive", "parallel", None, None),
        ),
        "hits are ranked": tuple((None, None, result, "none", None) for result in HITS),
        "nothing but hits is ranked": tuple(
            (None, None, result, rank, None)
            for result in results
            if result not in HITS
            for rank in ranks
            if rank != "none"
        ),
        "the slope along x is 100 in magnitude, never 0": (("x", "zero", None, None, None),),
        "primary rays run along positive x": (("x", "negative", None, None, "primary"),),
        **(_GIVEN_UP if engine.divides else _WITHOUT_MIRROR),
    }


# A control that waits for divisions ends a rectangle that no ray of the group runs towards.
_GIVEN_UP: dict[str, tuple[Pattern, ...]] = {
    "a group's primary rays run one way from one point; a plane that none runs towards is given up": (
        (None, None, "on plane", None, "primary"),
        (None, None, "behind", None, "primary"),
    ),
    "a group's rays have the row's slope along z, so a plane that one is parallel to is given up": (
        ("z", None, "parallel", None, None),
    ),
}
_WITHOUT_MIRROR: dict[str, tuple[Pattern, ...]] = {
    "primary rays have left no mirror": ((None, None, "before mirror", None, "primary"),),
}
IMPOSSIBLE = {name: _impossible_in(engine) for name, engine in ENGINES.items()}
"""By engine, bins that no ray can hit, by the reason; with culling."""


class FunctionalCoverage:
    """The bins, empty at first. cocotb-coverage keeps them in one place a process, so a new one replaces the last."""

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
            ValueError: an intersection that was held to be impossible.
        """
        for place in np.argwhere(counts):
            times = int(counts[tuple(place)])
            bins = tuple(values[index] for values, index in zip(self.points.values(), place, strict=True))
            if bins not in self.bins:
                raise ValueError(f"{', '.join(bins)}: is said to be impossible, and came {times} times")
            # cocotb-coverage counts one at a time; the rest of them is added to what it counted.
            self._sample(*bins)
            self.bins[bins] += times - 1
            for name, value in zip(self.points, bins, strict=True):
                coverage_db[f"raycaster.{name}"].detailed_coverage[value] += times - 1

    @property
    def bins(self) -> dict[Bin, int]:
        """How often each possible bin of the cross was hit."""
        return coverage_db[CROSS].detailed_coverage

    @property
    def holes(self) -> list[Bin]:
        """Bins that were not hit."""
        return [bins for bins, times in self.bins.items() if not times]

    @property
    def ignored(self) -> dict[str, int]:
        """How many bins of the cross are impossible, by the reason; one with several counts at the first."""
        found = dict.fromkeys(self._impossible, 0)
        for place in np.ndindex(SHAPE):
            bins = [values[index] for values, index in zip(self.points.values(), place, strict=True)]
            for reason, patterns in self._impossible.items():
                if any(all(want in (None, has) for want, has in zip(p, bins, strict=True)) for p in patterns):
                    found[reason] += 1
                    break
        return found

    def export(self, path: Path) -> None:
        """Write `path` with the endings .xml, as cocotb-coverage does, and .json."""
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
    """What the probes of a simulation counted in all its frames.

    Args:
        directory: in which it ran.

    Returns:
        int64, with an axis for each of the points, in order.
    """
    counts = np.zeros(np.prod(SHAPE), dtype=np.int64)
    for path in directory.glob("bins.*"):
        place, times = np.array(path.read_text().split(), dtype=np.int64).reshape(-1, 2).T
        np.add.at(counts, place, times)
    return counts.reshape(SHAPE)
