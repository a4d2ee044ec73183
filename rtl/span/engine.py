# SPDX-License-Identifier: MIT
"""The span engine, whose units draw rows as runs of columns of one colour, into lists of whole frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from raycaster.configuration import MOST_RECTANGLES, Configuration, Facts, Options
from raycaster.rtl.engine.engine import Engine, check_pairs
from raycaster.screens import LIST_SCREENS

RUNS_PER_ROW = 120
"""Mean runs of a row that a list holds by default; packaged scenes take at most 112 at 320 columns, 119 at 1920."""


class Span(Engine):
    """Units that draw rows as runs. A frame that is late is shown later, and never wrong."""

    @property
    def renderer(self) -> Callable[..., Any]:
        """`span_renderer`."""
        from raycaster.rtl.span.span_renderer import span_renderer

        return span_renderer

    def refuse(self, options: Options) -> None:
        """Refuse culling."""
        super().refuse(options)
        if options.culling:
            raise ValueError("culling: the span engine has no groups of columns; leave it out")

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take one unit, and lists that hold the packaged scenes."""
        if config.pixels > 1:
            check_pairs(config)
        screen = config.screen_geometry
        if options.list is not None and options.list < screen.rows:
            raise ValueError(f"list: {options.list} is less than a run for each of the {screen.rows} rows; take more")
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


SPAN = Span(
    Facts(
        name="span", code=3, colour="#CC79A7", marker="D", usual_build="5 s", screens=LIST_SCREENS,
        rectangles=MOST_RECTANGLES, whole_frames=True,
    )
)  # fmt: skip
