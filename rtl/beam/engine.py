# SPDX-License-Identifier: MIT
"""The beam engine, which tests all rectangles at once, one pixel per clock, in step with the monitor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from raycaster.complaints import as_typed
from raycaster.configuration import Configuration, Facts, Options
from raycaster.rtl.beam.beam_renderer import beam_renderer
from raycaster.rtl.beam.latencies import blanking_left
from raycaster.rtl.engine.engine import Engine, check_pairs
from raycaster.screens import BEAM_SCREENS


class Beam(Engine):
    """One lane per pixel of a clock, without a line buffer."""

    @property
    def renderer(self) -> Callable[..., Any]:
        """`beam_renderer`."""
        return beam_renderer

    def refuse(self, options: Options) -> None:
        """Refuse culling, and a number of units that is not that of the lanes."""
        super().refuse(options)
        if options.culling:
            raise ValueError("culling: the beam engine takes all rectangles at once; leave it out")
        if options.units not in (None, options.pixels):
            raise ValueError(
                f"units: the beam engine has one per pixel of a clock, {options.pixels} with "
                f"{as_typed('pixels', options.pixels)}, not {options.units}"
            )

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take one lane per pixel of a clock."""
        if config.pixels > 1:
            check_pairs(config)
        return replace(config, units=config.pixels)

    def describe(self, config: Configuration) -> str:
        """Return screen and lanes."""
        screen = config.screen_geometry
        return f"beam {screen.columns}x{screen.rows}" + (", 2 pixels per clock" if config.pixels == 2 else "")

    def label(self, config: Configuration) -> str:
        """Return rows and lanes."""
        return f"{config.screen_geometry.rows}p" + (" x2" if config.pixels == 2 else "")

    def check(self, config: Configuration) -> None:
        """Refuse a design that cannot set up a line within the monitor's blanking."""
        if (left := blanking_left(config)) >= 0:
            return
        turning = " and a camera that turns" if config.turn else ""
        paired = " at two pixels per clock" if config.pixels > 1 else ""
        ways = ["take fewer of either", *([as_typed("turn", 0)] if turning else [])]
        ways += [as_typed("pixels", 1)] if paired else []
        raise ValueError(
            f"rectangles: with {config.rectangles} of them, {config.reflections} reflections{turning}{paired}, the "
            f"beam engine is {-left} cycles short of a line's blanking on this screen; {' or '.join(ways)}"
        )


BEAM = Beam(
    Facts(
        name="beam", code=2, colour="#009E73", marker="^", usual_build="5 s", screens=BEAM_SCREENS, rect_latency=2,
        line_buffered=False,
        lacks={"light": "the beam engine casts no shadows, which would take more than twice its multipliers"},
    )
)  # fmt: skip
