# SPDX-License-Identifier: MIT
"""What a design costs in time and cells: foretold for many, simulated and counted for those that matter."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration, ConfigurationError, configure
from raycaster.fpga.area import with_units

RESULTS = Path("results")
"""What commands measured, of the clone that the report runs in."""

BEAMS: Sequence[Mapping[str, Any]] = (
    {"scale": 1},
    {},
    {"pixels": 2},
    {"rows": 180},
    {"rows": 180, "pixels": 2},
    {"rows": 180, "scale": 6},
    {"rows": 180, "scale": 6, "pixels": 2},
)
"""The beam engine at scales 1, 2, 4 and 6, with one pixel and two a clock."""

CULLED: Sequence[Mapping[str, Any]] = (
    {},
    {"rounding": "nearest", "divider_bits": 3},
    {"fraction_bits": 4, "rounding": "nearest", "divider_bits": 3},
    {"engine": "exact"},
)
"""Designs that are looked at with culling, where the time is the scene's."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A design, what it is foretold to need, and what it was found to need."""

    config: Configuration
    error: float
    """Mean share of wrong pixels."""

    foretold: int | None = None
    """LUT4 of an ECP5: the shared part, and one unit so many times."""

    counted: Mapping[str, int] | None = None
    """Its cells as a whole, by kind."""

    timing: Mapping[str, Any] | None = None
    """What simulation found, as `raycaster.report.points.TimePoint`."""

    @property
    def cells(self) -> int:
        """LUT4, counted where they were."""
        if self.counted:
            return self.counted["cells"]
        if self.foretold is None:
            raise ValueError(f"{self.config.name}: its cells are neither counted nor foretold")
        return self.foretold

    @property
    def frame_cycles(self) -> int:
        """Cycles in which a frame is computed: its counter's, where it was simulated."""
        if self.timing:
            return self.timing["frame_cycles"]
        return foretold_cycles(self.config)

    @property
    def pixel_ns(self) -> float:
        """Nanoseconds for each pixel of a frame, at the clock that the design needs."""
        return self.frame_ms * 1e6 / pixels(self.config)

    @property
    def frame_ms(self) -> float:
        """Milliseconds in which a frame is computed, likewise."""
        return 1000 * self.frame_cycles / self.config.screen_geometry.clock_hz

    @property
    def is_found(self) -> bool:
        """Nothing of it is foretold."""
        return self.counted is not None and self.timing is not None


Measure = Callable[[Candidate], float]


def foretold_cycles(config: Configuration) -> int:
    """Cycles of a frame in the worst case: rows of so many groups, each with all its rectangles.

    An engine without a line buffer computes a pixel as often as the monitor shows it.
    """
    screen = config.screen_geometry
    times = 1 if config.facts.line_buffered else screen.doubling**2
    return config.group_cycles * config.groups * screen.rows * times


def pixels(config: Configuration) -> int:
    """That are computed for a frame."""
    return config.screen_geometry.columns * config.screen_geometry.rows


def seed_designs(fractions: Iterable[int], units: Iterable[int], screen: str) -> list[Configuration]:
    """Every design of the seed engine of these that meets the row budget, with one reflection.

    Without culling, so that a design's time is one number, whatever the scene.
    """
    choices = itertools.product(fractions, units, ("truncate", "nearest"), (1, 2, 3))
    return _possible(
        {
            "fraction_bits": f,
            "units": count,
            "rounding": rounding,
            "divider_bits": bits,
            "screen": screen,
            "culling": False,
        }
        for f, count, rounding, bits in choices
    )


def exact_designs(units: Iterable[int], screen: str) -> list[Configuration]:
    """The same of the exact engine."""
    return _possible({"engine": "exact", "units": count, "screen": screen} for count in units)


def beam_designs(screen: str) -> list[Configuration]:
    """The same of the beam engine; of a screen other than VGA, the one that it has."""
    return _possible({"engine": "beam", "screen": screen, **one} for one in (BEAMS if screen == "vga" else [{}]))


def culled_designs(fractions: Iterable[int], screen: str) -> list[Configuration]:
    """Designs with culling, of those fraction bits."""
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
    """The design whose unit is synthesised by itself."""
    return with_units(config, 1)


def with_foretold(candidates: Sequence[Candidate], whole: Mapping[str, int], base: Configuration,
                  units: Mapping[Configuration, int]) -> list[Candidate]:  # fmt: skip
    """The same designs, each with the cells that it is foretold.

    Args:
        candidates: of one engine behind a line buffer.
        whole: the cells of one of its designs.
        base: that design.
        units: by `unit_of` each design, the cells of one unit by itself.
    """
    shared = whole["cells"] - base.units * units[unit_of(base)]
    return [replace(one, foretold=shared + one.config.units * units[unit_of(one.config)]) for one in candidates]


def frontier(candidates: Sequence[Candidate], *measures: Measure) -> list[Candidate]:
    """Those that no other is better than: nowhere worse, and somewhere better; in the order of the first measure."""
    values = {one: tuple(measure(one) for measure in measures) for one in candidates}

    def dominated(one: Candidate) -> bool:
        mine = values[one]
        return any(
            theirs != mine and all(a <= b for a, b in zip(theirs, mine, strict=True)) for theirs in values.values()
        )

    return sorted((one for one in candidates if not dominated(one)), key=lambda one: values[one])


def time(one: Candidate) -> float:
    """What is shown as time."""
    return one.pixel_ns


def error(one: Candidate) -> float:
    """What is shown as error."""
    return one.error


def cells(one: Candidate) -> float:
    """What is shown as size."""
    return one.cells


@cache
def routed_clocks() -> dict[str, float]:
    """By name of a configuration, the MHz that the system clock of its placed and routed board design reached."""
    found: dict[str, float] = {}
    for path in sorted(RESULTS.glob("bitstream-*.json")):
        kept = json.loads(path.read_text())
        name = kept["scope"].get("configuration")
        clock = kept["figures"]["clocks"].get("clk")
        if name and clock and name not in found:
            found[name] = clock[0]
    return found


def clock_words(config: Configuration) -> str:
    """The clock that a time is at, and the one that was reached where the design was placed and routed."""
    needed = f"{config.screen_geometry.clock_hz / 1e6:g} MHz"
    reached = routed_clocks().get(config.name)
    return f"{needed}, routed at {reached:g}" if reached else f"{needed}, required"


def describe(config: Configuration) -> str:
    """A design in a few words."""
    return config.facts.describe(config) + (", culling" if config.culling else "")
