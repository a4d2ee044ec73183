# SPDX-License-Identifier: MIT
"""The exact engine, which compares products instead of dividing."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from raycaster.engines.engine import LineBufferedEngine

if TYPE_CHECKING:
    from raycaster.configuration import Configuration, Options

WRITE_AT = 2
"""Bit of in_flight that is set three cycles after find_intersection, the latency of a unit's test."""

PATTERN_LATENCY = 6
"""Cycles until the cells of a pattern are known: three each for u and v, with two bits per cycle."""


AIM_CYCLES = 4
"""Cycles from the end of a pass to the start of the shadow pass: the shadow ray, a component per cycle."""


class Exact(LineBufferedEngine):
    """Units that test one rectangle per clock."""

    name, code = "exact", 1
    colour, marker = "#0072B2", "s"
    usual_build = "5 s"

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take as few units as meet the row budget."""
        if options.units is not None:
            return replace(config, units=options.units)
        return self.fewest_units(config)

    def describe(self, config: Configuration) -> str:
        """Return the number of units."""
        return f"exact, {config.units} units"

    def label(self, config: Configuration) -> str:
        """Return the number of units."""
        return str(config.units)

    def rect_cycles(self, config: Configuration) -> int:
        """Return 1, a rectangle per clock."""
        return 1

    def pass_latency(self, config: Configuration) -> int:
        """Add the stages after the last rectangle: test, depth comparison, cells of a pattern, and storing the ray."""
        return WRITE_AT + 2 + (PATTERN_LATENCY if config.patterns else 0)

    def group_cycles(self, config: Configuration) -> int:
        """Add a shadow pass to each pass."""
        shadows = sum(mask.bit_count() for mask in config.shadows)
        return super().group_cycles(config) + shadows + len(config.shadows) * (AIM_CYCLES + self.pass_latency(config))
