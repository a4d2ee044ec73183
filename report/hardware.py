# SPDX-License-Identifier: MIT
"""What a design's arithmetic costs in time and cells: foretold for many designs, measured for those that matter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from raycaster.configuration import CLOCK_HZ, Configuration, ConfigurationError, configure


@dataclass(frozen=True)
class Candidate:
    """A design, and what it is foretold to need."""

    config: Configuration
    error: float
    """Mean share of wrong pixels over the scenes."""

    cells: int
    """LUT4 of an ECP5: the shared part, and one unit so many times."""

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
    return 1000 * config.screen_geometry.rows * row_cycles / CLOCK_HZ


def designs(fractions: Iterable[int], units: Iterable[int], reflections: int, screen: str) -> list[Configuration]:
    """Every design of these that meets the row budget."""
    found = []
    for fraction_bits in fractions:
        for count in units:
            for rounding in ("truncate", "nearest"):
                for divider_bits in (1, 2, 3):
                    try:
                        found.append(
                            configure(
                                units=count, fraction_bits=fraction_bits, rounding=rounding,
                                divider_bits=divider_bits, reflections=reflections, screen=screen,
                            )
                        )  # fmt: skip
                    except ConfigurationError:
                        continue
    return found


def frontier(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Those that no other dominates, the fastest first."""
    best = [one for one in candidates if not any(other.dominates(one) for other in candidates)]
    return sorted(best, key=lambda one: (one.row_cycles, one.error, one.cells))


def foretell(
    configs: Sequence[Configuration],
    errors: Mapping[tuple[int, str], float],
    cells: Mapping[Configuration, int],
    shared: int,
) -> list[Candidate]:
    """Candidates from what was measured of scenes, by fraction bits and rounding, and of each design's one unit."""
    return [
        Candidate(config, errors[config.fraction_bits, config.rounding], shared + config.units * cells[config])
        for config in configs
    ]


def check_designs(config: Configuration) -> tuple[Configuration, Configuration]:
    """Two whole designs that the cells are checked on: one that the shared part is taken from, and one far from it."""
    return config, replace(config, fraction_bits=4, rounding="nearest", divider_bits=2, allow_underrun=True)
