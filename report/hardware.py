# SPDX-License-Identifier: MIT
"""Time and cells of designs: estimated for many, simulated and counted for the ones that matter."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration, ConfigurationError, configure
from raycaster.fpga.area import with_units

RESULTS = Path("results")
"""Folder of kept measurements, in the clone that the report runs in."""

BEAMS: Sequence[Mapping[str, Any]] = (
    {"scale": 1},
    {},
    {"pixels": 2},
    {"rows": 180},
    {"rows": 180, "pixels": 2},
    {"rows": 180, "scale": 6},
    {"rows": 180, "scale": 6, "pixels": 2},
)
"""Options for the beam engine at scales 1, 2, 4 and 6, with one or two pixels per clock."""

CULLED: Sequence[Mapping[str, Any]] = (
    {},
    {"rounding": "nearest", "divider_bits": 3},
    {"fraction_bits": 4, "rounding": "nearest", "divider_bits": 3},
    {"engine": "exact"},
)
"""Options of designs with culling, whose time depends on the scene."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A design with its estimated and measured cost."""

    config: Configuration
    error: float
    """Mean share of wrong pixels."""

    estimated: int | None = None
    """Estimated ECP5 LUT4 count: the shared part plus the units times the size of one."""

    counted: Mapping[str, int] | None = None
    """Counted cells of the whole design, by kind."""

    timing: Mapping[str, Any] | None = None
    """Simulation result: a point of the kind time, see `raycaster.report.points`."""

    @property
    def cells(self) -> int:
        """LUT4 count, or its estimate if the cells were not counted."""
        if self.counted:
            return self.counted["cells"]
        if self.estimated is None:
            raise ValueError(f"{self.config.name}: its cells are neither counted nor estimated")
        return self.estimated

    @property
    def frame_cycles(self) -> int:
        """Cycles to compute a frame: from the hardware's counter if simulated, otherwise predicted."""
        if self.timing:
            return self.timing["frame_cycles"]
        return predicted_cycles(self.config)

    @property
    def pixel_ns(self) -> float:
        """Nanoseconds to compute a pixel, at the clock that the design needs."""
        screen = self.config.screen_geometry
        return self.frame_ms * 1e6 / (screen.columns * screen.rows)

    @property
    def frame_ms(self) -> float:
        """Milliseconds to compute a frame, at the clock that the design needs."""
        return 1000 * self.frame_cycles / self.config.screen_geometry.clock_hz

    @property
    def is_found(self) -> bool:
        """True if the design was simulated and its cells were counted."""
        return self.counted is not None and self.timing is not None


def predicted_cycles(config: Configuration) -> int:
    """Predict the cycles per frame in the worst case, in which every group tests all rectangles.

    An engine without a line buffer computes a pixel as often as the monitor shows it.
    """
    screen = config.screen_geometry
    times = 1 if config.facts.line_buffered else screen.doubling**2
    return config.group_cycles * config.groups * screen.rows * times


def seed_designs(fractions: Iterable[int], units: Iterable[int], screen: str) -> list[Configuration]:
    """List the seed engine's designs with these options that meet the row budget, with one reflection.

    They have no culling, so that a design's time does not depend on the scene.
    """
    names = "fraction_bits", "units", "rounding", "divider_bits"
    choices = itertools.product(fractions, units, ("truncate", "nearest"), (1, 2, 3))
    return _possible(
        {"screen": screen, "culling": False, **dict(zip(names, choice, strict=True))} for choice in choices
    )


def exact_designs(units: Iterable[int], screen: str) -> list[Configuration]:
    """List the exact engine's designs that meet the row budget, with one reflection."""
    return _possible({"engine": "exact", "units": count, "screen": screen} for count in units)


def beam_designs(screen: str) -> list[Configuration]:
    """List the beam engine's designs with one reflection; just one for screens other than VGA."""
    return _possible({"engine": "beam", "screen": screen, **one} for one in (BEAMS if screen == "vga" else [{}]))


def culled_designs(fractions: Iterable[int], screen: str) -> list[Configuration]:
    """List designs with culling that have one of these numbers of fraction bits."""
    return _possible(
        {"screen": screen, "culling": True, **one} for one in CULLED if one.get("fraction_bits", 0) in set(fractions)
    )


def _possible(choices: Iterable[Mapping[str, Any]]) -> list[Configuration]:
    found = []
    for choice in choices:
        with suppress(ConfigurationError):
            found.append(configure(**choice))
    return found


def unit_of(config: Configuration) -> Configuration:
    """Return the design whose unit is synthesised on its own, for all designs with the same unit."""
    return with_units(config, 1)


def with_estimates(candidates: Sequence[Candidate], whole: Mapping[str, int], base: Configuration,
                  units: Mapping[Configuration, int]) -> list[Candidate]:  # fmt: skip
    """Add the estimated number of cells to each design.

    Args:
        candidates: designs of one engine with a line buffer.
        whole: counted cells of `base`.
        base: one design of the engine.
        units: cells of a single unit, by `unit_of` each design.
    """
    shared = whole["cells"] - base.units * units[unit_of(base)]
    return [replace(one, estimated=shared + one.config.units * units[unit_of(one.config)]) for one in candidates]


def frontier(candidates: Sequence[Candidate], *measures: str) -> list[Candidate]:
    """Return the designs that no other one dominates, ordered by the first of these attributes.

    A design dominates another if it is better by one measure and not worse by any.
    """
    values = {one: tuple(getattr(one, name) for name in measures) for one in candidates}

    def dominated(mine: tuple[float, ...]) -> bool:
        return any(
            theirs != mine and all(a <= b for a, b in zip(theirs, mine, strict=True)) for theirs in values.values()
        )

    return sorted((one for one in candidates if not dominated(values[one])), key=values.__getitem__)


@cache
def routed_clocks() -> dict[str, float]:
    """Return the MHz that the system clock reached in placed and routed board designs, by configuration name."""
    found: dict[str, float] = {}
    for path in sorted(RESULTS.glob("bitstream-*.json")):
        kept = json.loads(path.read_text())
        name = kept["scope"].get("configuration")
        clock = kept["figures"]["clocks"].get("clk")
        if name and clock and name not in found:
            found[name] = clock[0]
    return found


def clock_words(config: Configuration) -> str:
    """Describe the clock that a design needs, and the clock it reached if it was placed and routed."""
    needed = f"{config.screen_geometry.clock_hz / 1e6:g} MHz"
    reached = routed_clocks().get(config.name)
    return f"{needed}, routed at {reached:g}" if reached else f"{needed}, required"


def describe(config: Configuration) -> str:
    """Describe a design in a few words."""
    return config.facts.describe(config) + (", culling" if config.culling else "")
