# SPDX-License-Identifier: MIT
"""The engine that compares products instead of dividing."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from raycaster.engines.engine import LineBufferedEngine

if TYPE_CHECKING:
    from raycaster.configuration import Configuration, Options

WRITE_AT = 2
"""The bit of in_flight that comes three cycles after find_intersection: the latency of a unit's test."""

PATTERN_LATENCY = 6
"""Cycles until the cells of a pattern are known, of u and of v: a dividend, and three cycles of two bits each."""


AIM_CYCLES = 4
"""Cycles from the end of a pass to the start of the shadow pass: the shadow ray, a component per cycle."""


class Exact(LineBufferedEngine):
    """Units that test a rectangle a clock."""

    name, code = "exact", 1
    colour, marker = "#0072B2", "s"
    usual_build = "15 s"

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take as few units as meet the row budget."""
        if options.units is not None:
            return replace(config, units=options.units)
        return self.fewest_units(config)

    def describe(self, config: Configuration) -> str:
        """Units."""
        return f"exact, {config.units} units"

    def label(self, config: Configuration) -> str:
        """Units."""
        return str(config.units)

    def slot_cycles(self, config: Configuration) -> int:
        """Each clock has a rectangle."""
        return 1

    def pass_latency(self, config: Configuration) -> int:
        """The test's stages after the slot, depth compared, ray stored; the cells of a pattern come before that."""
        return WRITE_AT + 2 + (PATTERN_LATENCY if config.patterns else 0)

    def group_cycles(self, config: Configuration) -> int:
        """A shadow pass follows each pass."""
        shadows = sum(mask.bit_count() for mask in config.shadows)
        return super().group_cycles(config) + shadows + len(config.shadows) * (AIM_CYCLES + self.pass_latency(config))
