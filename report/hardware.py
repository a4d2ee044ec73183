# SPDX-License-Identifier: MIT
"""Designs with their time and cells: estimated for many, simulated and counted for the ones that matter."""

from __future__ import annotations

import itertools
import json
import statistics
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

from raycaster.configuration import Configuration, ConfigurationError, configure
from raycaster.outcomes import RESULTS
from raycaster.report.points import predicted_cycles

BEAMS: Sequence[Mapping[str, Any]] = (
    {"scale": 1}, {}, {"pixels": 2}, {"rows": 180}, {"rows": 180, "pixels": 2}, {"rows": 180, "scale": 6},
    {"rows": 180, "scale": 6, "pixels": 2},
)  # fmt: skip
"""Options for the beam engine at scales 1, 2, 4 and 6, with one or two pixels per clock."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A design with its estimated and measured cost."""

    config: Configuration
    error: float
    """Mean share of wrong pixels."""

    estimated: int = 0
    """Estimated ECP5 LUT4 count: the shared part plus the units times the size of one."""

    counted: Mapping[str, int] | None = None
    """Counted cells of the whole design, by kind."""

    timing: Mapping[str, Any] | None = None
    """Simulation result: a point of the kind time, see `raycaster.report.points`."""

    @property
    def title(self) -> str:
        """The design in a few words."""
        return self.config.facts.describe(self.config)

    @property
    def is_found(self) -> bool:
        """True if the design was simulated and its cells were counted."""
        return self.counted is not None and self.timing is not None

    @property
    def cells(self) -> int:
        """LUT4 count, or its estimate if the cells were not counted."""
        return self.counted["cells"] if self.counted else self.estimated

    @property
    def frame_cycles(self) -> int:
        """Cycles to compute a frame: from the hardware's counter if simulated, otherwise predicted."""
        return self.timing["frame_cycles"] if self.timing else predicted_cycles(self.config)

    @property
    def is_routed(self) -> bool:
        """True if the design was placed and routed, so that its time is at the clock that it reached."""
        return self.config.name in routed_clocks()

    @property
    def clock_mhz(self) -> float:
        """Routed clock, or the one that the design's monitor requires if it was not placed and routed."""
        return routed_clocks().get(self.config.name, required_mhz(self.config))

    @property
    def frame_ms(self) -> float:
        """Milliseconds to compute a frame, at `clock_mhz`."""
        return self.frame_cycles / self.clock_mhz / 1000

    @property
    def required_ms(self) -> float:
        """Milliseconds to compute a frame, at the clock that the design's monitor requires."""
        return self.frame_cycles / required_mhz(self.config) / 1000

    @property
    def work(self) -> float:
        """LUT4 occupied for a frame's time, in LUT4 times seconds."""
        return self.cells * self.frame_ms / 1000

    @property
    def seconds(self) -> Sequence[float]:
        """Seconds per frame that each run of Verilator's model took; none if it was not simulated here."""
        return (self.timing or {}).get("seconds", ())

    @property
    def simulated_s(self) -> float:
        """Median of `seconds`; NaN without any."""
        return statistics.median(self.seconds) if self.seconds else float("nan")


def seed_designs(fractions: Iterable[int], units: Iterable[int], screen: str = "vga") -> list[Configuration]:
    """List the seed engine's designs with these options that meet the row budget, with one reflection.

    They have no culling, so that a design's time does not depend on the scene.
    """
    names = "fraction_bits", "units", "rounding", "divider_bits"
    choices = itertools.product(fractions, units, ("truncate", "nearest"), (1, 2, 3))
    return _possible(screen, ({"culling": False, **dict(zip(names, choice, strict=True))} for choice in choices))


def exact_designs(units: Iterable[int], screen: str = "vga") -> list[Configuration]:
    """List designs without error: exact-engine designs that meet the row budget, and beam-engine designs.

    The beam engine has just one for screens other than VGA.
    """
    beams = BEAMS if screen == "vga" else [{}]
    exacts = ({"engine": "exact", "units": count} for count in units)
    return _possible(screen, [*exacts, *({"engine": "beam", **one} for one in beams)])


def _possible(screen: str, choices: Iterable[Mapping[str, Any]]) -> list[Configuration]:
    found = []
    for choice in choices:
        with suppress(ConfigurationError):
            found.append(configure(screen=screen, **choice))
    return found


def frontier(candidates: Sequence[Candidate], *measures: str) -> list[Candidate]:
    """Return the designs that no other one dominates, ordered by the first of these attributes.

    A design dominates another if it is better by one measure and not worse by any.
    """
    values = {one: tuple(getattr(one, name) for name in measures) for one in candidates}

    def dominates(theirs: tuple[float, ...], mine: tuple[float, ...]) -> bool:
        return theirs != mine and all(a <= b for a, b in zip(theirs, mine, strict=True))

    best = (one for one, mine in values.items() if not any(dominates(theirs, mine) for theirs in values.values()))
    return sorted(best, key=values.__getitem__)


@cache
def routed_clocks() -> dict[str, float]:
    """Return the MHz that the system clock reached when a design was placed and routed, by configuration name.

    The slowest counts, if a design was routed for several boards, with several seeds, or without a board.
    """
    found: dict[str, float] = {}
    for path in sorted(RESULTS.glob("*.json")):
        kept = json.loads(path.read_text())
        name, figures, reached = kept["scope"].get("configuration"), kept["figures"], []
        if path.name.startswith("bitstream-"):
            reached = [(name, clock) for clock in figures["clocks"].get("clk", [])[:1]]
        elif path.name.startswith("area-") and "routed_mhz" in figures:
            reached = [(name, figures["routed_mhz"])]
        elif path.name == "beside.json":
            ours = (row["design"].partition("RayCaster, ") + (row,) for row in figures["designs"])
            reached = [(configure(engine=engine).name, row["routed_mhz"]) for _, known, engine, row in ours if known]
        for one, mhz in reached:
            found[one] = min(mhz, found.get(one, mhz))
    return found


def required_mhz(config: Configuration) -> float:
    """Return the clock that the design's monitor requires, in MHz."""
    return config.screen_geometry.clock_hz / 1e6
