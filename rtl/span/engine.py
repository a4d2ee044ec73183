# SPDX-License-Identifier: MIT
"""The span engine, whose units draw rows as runs of columns of one colour, into lists of whole frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import MOST_RECTANGLES, Configuration, ConfigurationError, Facts, Options
from raycaster.rtl.engine.engine import Engine
from raycaster.screens import LIST_SCREENS, Screen

RUNS_PER_ROW = 120
"""Mean runs of a row that a list holds by default; packaged scenes take at most 112 at 320 columns, 119 at 1920."""


class Span(Engine):
    """Units that draw rows as runs. A frame that is late is shown later, and never wrong."""

    @property
    def renderer(self) -> Callable[..., Any]:
        """`span_renderer`."""
        from raycaster.rtl.span.span_renderer import span_renderer

        return span_renderer

    def scales(self, screen: Screen) -> tuple[int, ...]:
        """Return those for which the monitor has pixels; first the one with a ray per pixel."""
        return tuple(sorted(screen.scales, key=lambda scale: scale != screen.doubling))

    def refuse(self, options: Options) -> None:
        """Refuse culling."""
        super().refuse(options)
        if options.culling:
            raise ConfigurationError("culling: the span engine has no groups of columns; leave it out")

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take one unit, and lists that hold the packaged scenes."""
        if config.pixels > 1:
            _check_pairs(config)
        screen = config.screen_geometry
        if options.list is not None and options.list < screen.rows:
            raise ConfigurationError(
                f"list: {options.list} is less than a run for each of the {screen.rows} rows; take more"
            )
        entries = screen.rows * min(RUNS_PER_ROW, screen.columns) if options.list is None else options.list
        return replace(config, list=entries)

    def describe(self, config: Configuration) -> str:
        """Return the screen and the units."""
        screen = config.screen_geometry
        units = f"{config.units} unit{'s' * (config.units > 1)}"
        return f"span {screen.columns}x{screen.rows}, {units}" + (", 2 pixels per clock" * (config.pixels == 2))

    def label(self, config: Configuration) -> str:
        """Return rows and units."""
        return f"{config.screen_geometry.rows}p, {config.units}"

    def check(self, config: Configuration) -> None:
        """Accept any design: it draws as many frames per second as it can."""


def _check_pairs(config: Configuration) -> None:
    """Refuse two pixels per clock unless they are neighbouring columns and all sync edges are between clocks.

    Raises:
        ConfigurationError: the screen has no such pairs.
    """
    screen = config.whole_screen
    if screen.doubling != 1:
        finest = config.scale * screen.doubling
        raise ConfigurationError(
            f"pixels: 2 per clock need one column per pixel of the monitor, {as_typed('scale', finest)}, not "
            f"{config.scale}"
        )
    line = screen.horizontal
    if any(part % 2 for part in (line.visible, line.front, line.sync, line.back)):
        raise ConfigurationError(
            f"pixels: 2 per clock need an even width and blanking, which the {config.screen} screen lacks"
        )


SPAN = Span(
    Facts(
        name="span", code=3, colour="#CC79A7", marker="D", usual_build="5 s", screens=LIST_SCREENS,
        rectangles=MOST_RECTANGLES, whole_frames=True,
    )
)  # fmt: skip
