# SPDX-License-Identifier: MIT
"""What a design's arithmetic costs in time and cells: foretold for many designs, measured for those that matter."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from raycaster.configuration import Configuration, ConfigurationError, configure


@dataclass(frozen=True)
class Candidate:
    """A design, and what it is foretold to need."""

    config: Configuration
    error: float
    """Mean share of wrong pixels over the scenes."""

    cells: int
    """LUT4 of an ECP5: the shared part, and one unit so many times."""

    multipliers: int

    @property
    def row_cycles(self) -> int:
        """Cycles of the slowest row: as many groups, each with all its rectangles."""
        return self.config.group_cycles * self.config.groups

    @property
    def frame_ms(self) -> float:
        """Time to render a frame, if it were rendered without waiting for the monitor."""
        return frame_ms(self.config, self.row_cycles)

    def dominates(self, other: Candidate) -> bool:
        """Nowhere worse, and somewhere better."""
        mine, others = ((one.error, one.row_cycles, one.cells) for one in (self, other))
        return mine != others and all(a <= b for a, b in zip(mine, others, strict=True))


def frame_ms(config: Configuration, row_cycles: int) -> float:
    """Milliseconds that all rows of a frame take at the system's clock."""
    return 1000 * config.screen_geometry.rows * row_cycles / config.screen_geometry.clock_hz


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


def _possible(choices: Iterable[Mapping[str, Any]]) -> list[Configuration]:
    found = []
    for choice in choices:
        with suppress(ConfigurationError):
            found.append(configure(**choice))
    return found


def frontier(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Those that no other dominates, the fastest first."""
    best = [one for one in candidates if not any(other.dominates(one) for other in candidates)]
    return sorted(best, key=lambda one: (one.row_cycles, one.error, one.cells))


def checks(config: Configuration) -> tuple[Configuration, Configuration]:
    """Two whole designs that the cells are checked on: one that the shared part is taken from, and one far from it."""
    if config.engine == "exact":
        return config, replace(config, units=4 * config.units)
    return config, replace(config, fraction_bits=4, rounding="nearest", divider_bits=2, allow_underrun=True)
