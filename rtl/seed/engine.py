# SPDX-License-Identifier: MIT
"""The seed engine, which divides and rounds the quotients."""

from __future__ import annotations

from dataclasses import replace

from raycaster.configuration import Configuration, ConfigurationError, Facts, Options
from raycaster.rtl.buffered.engine import Blocks, LineBufferedEngine
from raycaster.screens import SCREENS

UNIT_CELLS = {1: 559, 2: 607, 3: 647}
"""ECP5 LUT4s per unit, by quotient bits per cycle; from `make area DIVIDER_BITS=`."""

DEFAULT_UNITS = 32


class Seed(LineBufferedEngine):
    """Units with a divider each, which a rectangle occupies for the duration of a division.

    A rounded coordinate is off by less than one, and the depth is measured along x.
    """

    @property
    def blocks(self) -> Blocks:
        """`ray_control` and `ray_unit`."""
        from raycaster.rtl.seed.ray_control import ray_control
        from raycaster.rtl.seed.ray_unit import ray_unit

        return ray_control, ray_unit

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take 32 units, or the fewest that a fixed scene needs, and the smallest divider that meets the row budget."""
        given = options.divider_bits
        if given not in ("auto", *UNIT_CELLS):
            raise ConfigurationError(f"divider_bits: must be auto, 1, 2 or 3, not {given}")
        designs = [replace(config, divider_bits=bits) for bits in UNIT_CELLS if given in ("auto", bits)]
        if options.units is None and config.fixed is not None:
            # A faster divider makes a unit larger, but there may be fewer of them.
            return min(map(self.fewest_units, designs), key=lambda one: one.units * UNIT_CELLS[one.divider_bits])
        designs = [replace(one, units=options.units or DEFAULT_UNITS) for one in designs]
        return next((one for one in designs if self.fits(one)), designs[-1])

    def describe(self, config: Configuration) -> str:
        """Return fraction, rounding, units and divider."""
        bits = f"{config.divider_bits} bit{'s' if config.divider_bits > 1 else ''} per cycle"
        return f"seed F = {config.fraction_bits} {config.rounding}, {config.units} units, {bits}"

    def label(self, config: Configuration) -> str:
        """Return fraction and rounding."""
        return f"F{config.fraction_bits}{config.rounding[0]}"

    def rect_cycles(self, config: Configuration) -> int:
        """Return the cycles of a division."""
        return config.divider_steps

    def pass_latency(self, config: Configuration) -> int:
        """Add the stages: slope and plane latched, product, divider loaded, hit point, depth compared, ray stored."""
        from raycaster.rtl.seed.intersection_helper import LOAD_AT, WRITE_AFTER

        return LOAD_AT + WRITE_AFTER + 2


SEED = Seed(
    Facts(
        name="seed", code=0, colour="#D55E00", marker="o", usual_build="8 s", screens=SCREENS, margin=1, divides=True,
        lacks={
            "turn": "the seed engine measures depth along x, so its camera cannot turn",
            "light": "the seed engine rounds the points from which shadows would be cast",
        },
    )
)  # fmt: skip
