# SPDX-License-Identifier: MIT
"""Base class of the engines with a line buffer."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration, ConfigurationError, Options
from raycaster.rtl.engine.engine import Engine

GROUP_OVERHEAD = 4
"""Fixed cycles per group: the write to the line buffer with the two-cycle reset, idling, ray generation."""

Blocks = tuple[Callable[..., Any], Callable[..., Any]]
"""The block that operates all units, and the block of one unit."""


class LineBufferedEngine(Engine):
    """An engine whose units fill a line buffer, a group of neighbouring columns at a time."""

    @property
    @abstractmethod
    def blocks(self) -> Blocks:
        """The engine's control and unit."""

    @property
    def renderer(self) -> Callable[..., Any]:
        """`ray_caster_renderer` with this engine's units."""
        from raycaster.rtl.buffered.ray_caster_renderer import ray_caster_renderer

        control, unit = self.blocks
        return partial(ray_caster_renderer, control=control, unit=unit)

    def refuse(self, options: Options) -> None:
        """Refuse lists, and culling in a fixed scene."""
        super().refuse(options)
        if options.list:
            raise ConfigurationError(
                f"list: the {self.facts.name} engine has no lists of runs; leave out {options.list}"
            )
        if options.culling and options.fixed is not None:
            either = f"{as_typed('culling')} or {as_typed('fix')}"
            raise ConfigurationError(f"culling: does not apply to a fixed scene; leave out {either}")

    @abstractmethod
    def rect_cycles(self, config: Configuration) -> int:
        """Return the cycles from one rectangle to the next."""

    @abstractmethod
    def pass_latency(self, config: Configuration) -> int:
        """Return the cycles from a pass's last rectangle to the next pass."""

    def group_cycles(self, config: Configuration) -> int:
        """Return the cycles per group in the worst case, with all rectangles enabled.

        They are those for the rectangles of each pass, the latency of each pass, and the overhead of a group.
        """
        tests = sum(mask.bit_count() for mask in config.passes) * self.rect_cycles(config)
        return tests + len(config.passes) * self.pass_latency(config) + GROUP_OVERHEAD

    def fewest_units(self, config: Configuration) -> Configuration:
        """Return the design with the fewest units that meet the row budget, or one unit per column if none do."""
        columns = config.screen_geometry.columns
        tried = (replace(config, units=units) for units in range(1, columns + 1) if columns % units == 0)
        return next((one for one in tried if self.fits(one)), replace(config, units=columns))

    def fits(self, config: Configuration) -> bool:
        """Return True if a row is ready before the row above it has been shown."""
        return self.group_cycles(config) <= config.group_budget

    def check(self, config: Configuration) -> None:
        """Compare a group's cycles with the row budget."""
        if config.allow_underrun or self.fits(config):
            return
        raise ConfigurationError(
            f"row budget: a group of {config.units} columns takes {self.group_cycles(config)} cycles with "
            f"{config.rectangles} rectangles, {config.most_reflections} reflections and {self.rect_cycles(config)} "
            f"cycles per rectangle, but a row leaves it {config.group_budget} (less than "
            f"{config.screen_geometry.row_cycles} cycles over {config.groups} groups); take more units or divider "
            f"bits, fewer rectangles, reflections or fraction bits, or {as_typed('allow_underrun', True)}"
        )
