# SPDX-License-Identifier: MIT
"""The exact engine, which compares products instead of dividing."""

from __future__ import annotations

from dataclasses import replace

from raycaster.configuration import Configuration, Facts, Options
from raycaster.rtl.buffered.engine import Blocks, LineBufferedEngine
from raycaster.screens import SCREENS


class Exact(LineBufferedEngine):
    """Units that test one rectangle per clock."""

    @property
    def blocks(self) -> Blocks:
        """`exact_control` and `exact_unit`."""
        from raycaster.rtl.exact.exact_control import exact_control
        from raycaster.rtl.exact.exact_unit import exact_unit

        return exact_control, exact_unit

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
        from raycaster.rtl.exact.exact_control import PATTERN_LATENCY, WRITE_AT

        return WRITE_AT + 2 + (PATTERN_LATENCY if config.patterns else 0)

    def group_cycles(self, config: Configuration) -> int:
        """Add a shadow pass to each pass."""
        from raycaster.rtl.common.interfaces import AIM_CYCLES

        shadows = sum(mask.bit_count() for mask in config.shadows)
        return super().group_cycles(config) + shadows + len(config.shadows) * (AIM_CYCLES + self.pass_latency(config))


EXACT = Exact(Facts(name="exact", code=1, colour="#0072B2", marker="s", usual_build="5 s", screens=SCREENS))
