# SPDX-License-Identifier: MIT
"""Interface of the engines: the facts that each of them states."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from raycaster.complaints import as_typed
from raycaster.screens import SCREENS, Screen

if TYPE_CHECKING:
    from raycaster.configuration import Configuration, Options


LOOK_NAMES = {
    "turn": "a camera that turns",
    "materials": "rectangles that mirror more or less than half",
    "patterns": "rectangles with patterns",
    "light": "a light",
}
"""Purposes of the options for optional features of scenes."""

LOOKS = tuple(LOOK_NAMES)
"""Options for optional features of scenes."""

SMALLEST_CELL_BITS = 3
"""log2 of the size of a pattern's smallest cell, in world units."""

SETUP_LATENCY = 5
"""Cycles from rect_setup's start_line to the first rectangle's products."""


class Engine(ABC):
    """An engine, the hardware that computes the rays.

    Attributes:
        name: name for users.
        code: value of the register `engine`.
        colour: colour of its marks and lines in plots, from the palette of Okabe and Ito.
        marker: Matplotlib's name for the marker of its points in plots.
        usual_build: usual time to convert its default design and to build it with Verilator on two cores, estimated
            from processor time.
        screens: screens that it can fill, by name and rows.
        rect_latency: cycles from `fetch` to the rectangle.
        margin: distance by which a primary ray that hits a rectangle may pass outside its bounds, in world units.
        lacks: options of `LOOKS` that it refuses, each with the reason.
        divides: True if it forms quotients, which have fraction bits and are rounded.
        line_buffered: True if units fill a line buffer ahead of the monitor, group by group.
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
        """Options of `LOOKS` that a design can have."""
        return tuple(look for look in LOOKS if look not in self.lacks)

    def scales(self, screen: Screen) -> tuple[int, ...]:
        """Return the resolution scales that it offers on a screen, the default first."""
        return (1,)

    def refuse(self, options: Options) -> None:
        """Refuse options that the engine does not support.

        Raises:
            ValueError: an option is refused; the text is `option: why, and what to do instead`.
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
            either = f"{as_typed('culling')} or {as_typed('fix')}"
            raise ValueError(f"culling: does not apply to a fixed scene; leave out {either}")

    def culls(self, options: Options) -> bool:
        """Return True if a design has culling by default."""
        return False

    @abstractmethod
    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Choose the number of units and, for an engine that divides, the divider.

        Args:
            config: the design, with these undecided.
            options: the user's options.

        Raises:
            ValueError: the user's options are not possible.
        """

    @abstractmethod
    def rect_cycles(self, config: Configuration) -> int:
        """Return the cycles from one rectangle to the next; 0 if all are tested at once."""

    @abstractmethod
    def pass_latency(self, config: Configuration) -> int:
        """Return the cycles from the end of a pass's last rectangle to the first cycle of the next pass."""

    @abstractmethod
    def group_cycles(self, config: Configuration) -> int:
        """Return the cycles per group in the worst case, with all rectangles enabled."""

    @abstractmethod
    def describe(self, config: Configuration) -> str:
        """Describe a design in a few words."""

    @abstractmethod
    def label(self, config: Configuration) -> str:
        """Return a label for plots that distinguishes a design from others of the engine."""

    @abstractmethod
    def check(self, config: Configuration) -> None:
        """Refuse a design that is too slow for its screen.

        Raises:
            ValueError: the design is too slow; the text says by how much, and what to do.
        """


class LineBufferedEngine(Engine):
    """An engine whose units fill a line buffer, a group of neighbouring columns at a time."""

    GROUP_OVERHEAD: ClassVar[int] = 4
    """Fixed cycles per group: the write to the line buffer with the two-cycle reset, idling, ray generation."""

    def group_cycles(self, config: Configuration) -> int:
        """Add the cycles for the rectangles of each pass, the latency of each pass, and the overhead of a group."""
        tests = sum(mask.bit_count() for mask in config.passes) * self.rect_cycles(config)
        return tests + len(config.passes) * self.pass_latency(config) + self.GROUP_OVERHEAD

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
        raise ValueError(
            f"row budget: a group of {config.units} columns takes {config.group_cycles} cycles with "
            f"{config.rectangles} rectangles, {config.reflections} reflections and {config.rect_cycles} cycles per "
            f"rectangle, but a row leaves it {config.group_budget} (less than {config.screen_geometry.row_cycles} "
            f"cycles over {config.groups} groups); take more units or divider bits, fewer rectangles, reflections or "
            f"fraction bits, or {as_typed('allow_underrun', True)}"
        )
