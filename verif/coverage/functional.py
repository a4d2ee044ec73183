# SPDX-License-Identifier: MIT
"""Functional coverage: kinds of things in scenes, counted in the golden model, in cocotb-coverage's bins.

The hardware needs no probes: benches compare every pixel of these scenes with the golden model, and `make trace` the
values that lead to it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cocotb_coverage.coverage import CoverCross, CoverPoint, coverage_db, coverage_section

from raycaster.configuration import Configuration
from raycaster.golden.engines import model_of
from raycaster.golden.model import Trace
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import Scene

RAYS = "primary", "first", "second"
BLOCK_ROWS = 24
"""Rows of rays whose intermediate values are in memory at a time."""

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

    def counted(self, places: Iterable[Sequence[np.ndarray | int]]) -> np.ndarray:
        """Count arrays of places, given by their index on each axis; int64, with one axis per point."""
        counts = np.zeros(np.prod(self.shape), dtype=np.int64)
        for place in places:
            flat = np.ravel_multi_index(np.broadcast_arrays(*place), self.shape)
            counts += np.bincount(flat, minlength=counts.size)
        return counts.reshape(self.shape)


def traces(scene: Scene, config: Configuration, *, keep: bool = False) -> Iterator[tuple[Rectangles, Trace]]:
    """Trace a scene's picture in the golden model: some whole rows at a time, with the scene's rectangles."""
    rectangles, camera = Rectangles.of_scene(scene), scene.camera
    slopes = primary_slopes(config.screen_geometry, camera.basis)
    for first in range(0, len(slopes), BLOCK_ROWS):
        rays = slopes[first : first + BLOCK_ROWS].reshape(-1, 3)
        arguments = rectangles, camera.position, scene.background, rays, scene.reflections
        yield rectangles, model_of(config).trace(*arguments, light=scene.light, keep=keep)


class FunctionalCoverage:
    """Bins, empty at first. cocotb-coverage keeps one set per process, so a new object replaces the last one."""

    def __init__(self, cross: Cross):
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
