# SPDX-License-Identifier: MIT
"""Base class of the engines."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration, Facts, Options
from raycaster.screens import Screen


@dataclass(frozen=True, eq=False)
class Engine(ABC):
    """An engine: its facts, its blocks, their timing, and the choices that are left to it."""

    facts: Facts

    @property
    @abstractmethod
    def renderer(self) -> Callable[..., Any]:
        """The block that fills the screen, with the ports of `ray_caster_renderer`."""

    def scales(self, screen: Screen) -> tuple[int, ...]:
        """Return the resolution scales that it offers on a screen, the default first.

        Without a line buffer they are those for which the monitor has pixels; first the one with a ray per pixel.
        """
        if not self.facts.whole_frames:
            return (1,)
        return tuple(sorted(screen.scales, key=lambda scale: scale != screen.doubling))

    def refuse(self, options: Options) -> None:
        """Refuse options that the engine does not support.

        Raises:
            ValueError: an option is refused; the text is `option: why, and what to do instead`.
        """
        if not self.facts.whole_frames and options.list:
            raise ValueError(f"list: the {self.facts.name} engine has no lists of runs; leave out {options.list}")
        if not self.facts.divides:
            if options.fraction_bits:
                raise ValueError(f"fraction_bits: the {self.facts.name} engine has none, not {options.fraction_bits}")
            if options.rounding != "truncate":
                raise ValueError(f"rounding: the {self.facts.name} engine does not round; leave out {options.rounding}")
            if options.divider_bits not in ("auto", 0):
                raise ValueError(
                    f"divider_bits: the {self.facts.name} engine has no divider; leave out {options.divider_bits}"
                )
        if options.culling and options.fixed is not None:
            either = f"{as_typed('culling')} or {as_typed('fix')}"
            raise ValueError(f"culling: does not apply to a fixed scene; leave out {either}")

    @abstractmethod
    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Choose the number of units and, for an engine that divides, the divider.

        Args:
            config: the design, with these undecided.
            options: the user's options.

        Raises:
            ValueError: the user's options are not possible.
        """

    def rect_cycles(self, config: Configuration) -> int:
        """Return the cycles from one rectangle to the next; 0 without groups of columns."""
        return 0

    def pass_latency(self, config: Configuration) -> int:
        """Return the cycles from a pass's last rectangle to the next pass; 0 without groups of columns."""
        return 0

    def group_cycles(self, config: Configuration) -> int:
        """Return the cycles per group in the worst case, with all rectangles enabled; 1 without groups."""
        return 1

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


def check_pairs(config: Configuration) -> None:
    """Refuse two pixels per clock unless they are neighbouring columns and all sync edges are between clocks.

    Raises:
        ValueError: the screen has no such pairs.
    """
    screen = config.whole_screen
    if screen.doubling != 1:
        finest = config.scale * screen.doubling
        raise ValueError(
            f"pixels: 2 per clock need one column per pixel of the monitor, {as_typed('scale', finest)}, not "
            f"{config.scale}"
        )
    line = screen.horizontal
    if any(part % 2 for part in (line.visible, line.front, line.sync, line.back)):
        raise ValueError(f"pixels: 2 per clock need an even width and blanking, which the {config.screen} screen lacks")
