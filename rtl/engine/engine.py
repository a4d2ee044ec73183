# SPDX-License-Identifier: MIT
"""Base class of the engines."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from raycaster.configuration import Configuration, ConfigurationError, Facts, Options
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
        """Return the resolution scales that it offers on a screen, the default first."""
        return (1,)

    def refuse(self, options: Options) -> None:
        """Refuse options that the engine does not support.

        Raises:
            ConfigurationError: an option is refused; the text is `option: why, and what to do instead`.
        """
        name = self.facts.name
        if self.facts.divides:
            return
        if options.fraction_bits:
            raise ConfigurationError(f"fraction_bits: the {name} engine has none, not {options.fraction_bits}")
        if options.rounding != "truncate":
            raise ConfigurationError(f"rounding: the {name} engine does not round; leave out {options.rounding}")
        if options.divider_bits not in ("auto", 0):
            raise ConfigurationError(
                f"divider_bits: the {name} engine has no divider; leave out {options.divider_bits}"
            )

    @abstractmethod
    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Choose the number of units and, for an engine that divides, the divider.

        Args:
            config: the design, with these undecided.
            options: the user's options.

        Raises:
            ConfigurationError: the user's options are not possible.
        """

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
            ConfigurationError: the design is too slow; the text says by how much, and what to do.
        """
