# SPDX-License-Identifier: MIT
"""What every engine tells of itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from raycaster.screens import SCREENS, Screen

if TYPE_CHECKING:
    from raycaster.configuration import Configuration, Options


LOOKS = ("turn", "materials", "patterns", "light")
"""Options that add to what scenes may show."""

SMALLEST_CELL_BITS = 3
"""log2 of the size of a pattern's smallest cell, in world units."""

SETUP_LATENCY = 5
"""Cycles from rect_setup's start_line to the first rectangle's products."""


class Engine(ABC):
    """What computes the rays.

    Attributes:
        name: as users choose it.
        code: what the register `engine` reads.
        colour: of its marks and lines in plots; one that Okabe and Ito chose for this.
        marker: of its points in plots, as Matplotlib names it.
        usual_build: how long its default design usually takes to convert and to build with Verilator, on two cores;
            estimated from processor time.
        screens: those that it can fill, by name and rows.
        rect_latency: cycles from `fetch` to the rectangle.
        margin: how far outside a rectangle's bounds a primary ray may pass that hits it, in world units.
        lacks: the options of `LOOKS` that it refuses, each with the reason.
        divides: whether it forms quotients, which have a fraction and are rounded.
        line_buffered: whether units fill a line buffer ahead of the monitor, group after group.
    """

    name: ClassVar[str]
    code: ClassVar[int]
    colour: ClassVar[str]
    marker: ClassVar[str]
    usual_build: ClassVar[str]
    screens: ClassVar[Mapping[tuple[str, int], Screen]] = SCREENS
    rect_latency: ClassVar[int] = 1
    margin: ClassVar[int] = 0
    lacks: ClassVar[Mapping[str, str]] = {}
    divides: ClassVar[bool] = False
    line_buffered: ClassVar[bool] = True

    @property
    def looks(self) -> tuple[str, ...]:
        """The options of `LOOKS` that a design can have."""
        return tuple(look for look in LOOKS if look not in self.lacks)

    def scales(self, screen: Screen) -> tuple[int, ...]:
        """The resolution scales that it offers on a screen, the default first."""
        return (1,)

    def refuse(self, options: Options) -> None:
        """Refuse what the engine cannot do.

        Raises:
            ValueError: `option: why, and what to do instead`.
        """
        if not self.divides:
            if options.fraction_bits:
                raise ValueError(f"fraction_bits: the {self.name} engine has none, not {options.fraction_bits}")
            if options.rounding != "truncate":
                raise ValueError(f"rounding: the {self.name} engine does not round; leave out {options.rounding}")
            if options.divider_bits not in ("auto", 0):
                raise ValueError(
                    f"divider_bits: the {self.name} engine has no divider; leave out {options.divider_bits}"
                )
        if options.culling and options.fixed is not None:
            raise ValueError("culling: is for scenes that change; leave it out, or what is fixed")

    def culls(self, options: Options) -> bool:
        """Whether a design has culling where the user does not say."""
        return False

    @abstractmethod
    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Choose the units and, of an engine that divides, the divider.

        Args:
            config: the design, in which these are not decided.
            options: what the user gave.

        Raises:
            ValueError: what the user gave is not possible.
        """

    @abstractmethod
    def slot_cycles(self, config: Configuration) -> int:
        """Cycles from one rectangle to the next; 0 where it takes all at once."""

    @abstractmethod
    def pass_latency(self, config: Configuration) -> int:
        """Cycles from the end of a pass's last slot to the first cycle of the next pass."""

    @abstractmethod
    def group_cycles(self, config: Configuration) -> int:
        """Cycles from one group's start to the next one's with all rectangles enabled: the worst case."""

    @abstractmethod
    def describe(self, config: Configuration) -> str:
        """A design in a few words."""

    @abstractmethod
    def label(self, config: Configuration) -> str:
        """What distinguishes a design from others of the engine, as short as a plot wants it."""

    @abstractmethod
    def check(self, config: Configuration) -> None:
        """Refuse a design that is too slow for its screen.

        Raises:
            ValueError: by how much, and what to do.
        """


class LineBufferedEngine(Engine):
    """An engine whose units fill a line buffer, a group of neighbouring columns at a time."""

    GROUP_OVERHEAD: ClassVar[int] = 4
    """Cycles a group pays once: the write to the line buffer with the reset of two cycles, idling, ray generation."""

    def refuse(self, options: Options) -> None:
        """Refuse two pixels a clock."""
        if options.pixels != 1:
            raise ValueError(f"pixels: 2 a clock need the beam engine, ENGINE=beam, not {self.name}")
        super().refuse(options)

    def group_cycles(self, config: Configuration) -> int:
        """Slots for the rectangles of each pass, what follows each pass, and the overhead of a group."""
        slots = sum(mask.bit_count() for mask in config.passes) * self.slot_cycles(config)
        return slots + len(config.passes) * self.pass_latency(config) + self.GROUP_OVERHEAD

    def fewest_units(self, config: Configuration) -> Configuration:
        """The design with the fewest units that meet the row budget, or one for each column where none do."""
        columns = config.screen_geometry.columns
        tried = (replace(config, units=units) for units in range(1, columns + 1) if columns % units == 0)
        return next((one for one in tried if self.fits(one)), replace(config, units=columns))

    def fits(self, config: Configuration) -> bool:
        """Whether a row is ready before the row above it was shown."""
        return self.group_cycles(config) <= config.group_budget

    def check(self, config: Configuration) -> None:
        """Hold a group's cycles against the row budget."""
        if config.allow_underrun or self.fits(config):
            return
        raise ValueError(
            f"row budget: a group of {config.units} columns takes {config.group_cycles} cycles with "
            f"{config.rectangles} rectangles, {config.reflections} reflections and {config.slot_cycles} cycles a "
            f"rectangle, but a row leaves it {config.group_budget} (less than {config.screen_geometry.row_cycles} "
            f"cycles over {config.groups} groups); take more units or divider bits, fewer rectangles, reflections or "
            "fraction bits, or ALLOW_UNDERRUN=1"
        )
