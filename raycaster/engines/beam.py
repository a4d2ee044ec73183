# SPDX-License-Identifier: MIT
"""The beam engine, which tests all rectangles at once, one pixel per clock, in step with the monitor.

The blocks in `raycaster.rtl.beam` take their latencies from here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from raycaster.complaints import as_typed
from raycaster.engines.engine import SETUP_LATENCY, SMALLEST_CELL_BITS, Engine
from raycaster.screens import BEAM_SCREENS, COORDINATE_BITS, Screen

if TYPE_CHECKING:
    from raycaster.configuration import Configuration, Options

AIM_LATENCY = 5
"""Cycles from start_line to the first ray."""

ENTRY_LATENCY = 1
"""Cycles from next_column to the first walkers' step."""

TESTER_LATENCY = 3
"""Cycles from the way to the hit in ray_tester and fold_tester."""

FOLD_LATENCY = 3
"""Latency of ray_fold, in cycles."""

LOOK_UP_LATENCY = 1
"""Cycles from a winner to its facet and its surface."""

CELL_SLOPE_AT = 2
"""Cycles from the winner to the slope's magnitudes, as hit_cells reads them."""

CELL_LATENCY = CELL_SLOPE_AT + 3 + COORDINATE_BITS - SMALLEST_CELL_BITS
"""Cycles from a winner to the cells of its pattern: products, their sum, then one quotient bit per cycle."""

SEEN_LATENCY = MEAN_LATENCY = MIX_LATENCY = 1
"""Latencies of colour_seen, colour_mean and colour_mix, in cycles."""


def rounds(config: Configuration) -> int:
    """Return the number of pairwise rounds that find the nearest of a pass's rectangles, at least one."""
    most = max(mask.bit_count() for mask in config.passes)
    return max(1, (most - 1).bit_length())


def contest_latency(config: Configuration) -> int:
    """Return the cycles per round, one of them for the multipliers' outputs to travel if wires are long."""
    return 3 if config.has_long_wires else 2


def winner_latency(config: Configuration) -> int:
    """Return the cycles from a pass's ray to the rectangle that it sees."""
    return TESTER_LATENCY + rounds(config) * contest_latency(config)


def is_staged(config: Configuration) -> bool:
    """Return True if a tester registers what it selects from the fold and the slope.

    It does if the camera turns, which makes all words wider, or if wires are long.
    """
    return config.turn or config.has_long_wires


def fold_lead(config: Configuration) -> int:
    """Return the cycles from the fold to the way."""
    return 1 if is_staged(config) else 0


def slope_at(config: Configuration) -> int:
    """Return the cycles from the way to the slope's magnitudes."""
    return 1 if is_staged(config) else 2


def pass_latency(config: Configuration) -> int:
    """Return the cycles from a ray to its reflection."""
    return winner_latency(config) + LOOK_UP_LATENCY + FOLD_LATENCY + fold_lead(config)


def cell_latency(config: Configuration) -> int:
    """Return the cycles from a winner to the hit cells of its pattern; 0 without patterns."""
    return CELL_LATENCY if config.patterns else 0


def mixes(config: Configuration) -> bool:
    """Return True if mirrors may show more or less than half."""
    return config.materials and config.reflections > 0


def blend_latency(config: Configuration) -> int:
    """Return the cycles from the colours seen to the pixel."""
    return SEEN_LATENCY + (config.reflections * MIX_LATENCY if mixes(config) else MEAN_LATENCY)


def tested(config: Configuration) -> list[list[int]]:
    """List the numbers of the rectangles that the primary ray and each reflection are tested against.

    A reflection for which a fixed scene leaves no rectangles is omitted; the primary ray always has at least one.
    """
    return [[i for i in range(config.rectangles) if mask >> i & 1] for mask in config.passes if mask]


def beam_latency(config: Configuration) -> int:
    """Return the cycles from next_column to the column's colour."""
    reflections = len(tested(config)) - 1
    entered = ENTRY_LATENCY + reflections * pass_latency(config)
    return entered + winner_latency(config) + cell_latency(config) + LOOK_UP_LATENCY + blend_latency(config)


def start_cycles(config: Configuration) -> int:
    """Return the cycles from start_line until the first column may come."""
    if not config.turn:
        # With two lanes, lane_start registers their starts.
        return SETUP_LATENCY + config.rectangles + config.pixels - 1
    # A sweep reads its slope from the third cycle on, and the next sweep starts with its last load.
    return AIM_LATENCY - 3 + (config.pixels + 1) * (SETUP_LATENCY + config.rectangles - 1) + 1


def blanking_left(config: Configuration) -> int:
    """Return the blanking cycles left in a line when its first column starts; negative if that is too late."""
    horizontal = config.screen_geometry.beats
    # The horizontal sync is seen one pixel late, and the columns start early by their latency.
    return horizontal.blank - horizontal.front - beam_latency(config) - 1 - start_cycles(config)


class Beam(Engine):
    """One lane per pixel of a clock, without a line buffer."""

    name, code = "beam", 2
    colour, marker = "#009E73", "^"
    usual_build = "5 s"
    screens = BEAM_SCREENS
    rect_latency = 2
    line_buffered = False
    lacks: ClassVar = {"light": "the beam engine casts no shadows, which would take more than twice its multipliers"}

    def scales(self, screen: Screen) -> tuple[int, ...]:
        """Return the scales for which the monitor has pixels; first the one with a ray per pixel."""
        return tuple(sorted(screen.scales, key=lambda scale: scale != screen.doubling))

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
            self._check_pairs(config)
        return replace(config, units=config.pixels)

    def describe(self, config: Configuration) -> str:
        """Return screen and lanes."""
        screen = config.screen_geometry
        return f"beam {screen.columns}x{screen.rows}" + (", 2 pixels per clock" if config.pixels == 2 else "")

    def label(self, config: Configuration) -> str:
        """Return rows and lanes."""
        return f"{config.screen_geometry.rows}p" + (" x2" if config.pixels == 2 else "")

    def rect_cycles(self, config: Configuration) -> int:
        """Return 0, as all rectangles are tested at once."""
        return 0

    def pass_latency(self, config: Configuration) -> int:
        """Return 0, as every pass starts again in each clock."""
        return 0

    def group_cycles(self, config: Configuration) -> int:
        """Return 1, as a group is the pixels of one clock."""
        return 1

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

    @staticmethod
    def _check_pairs(config: Configuration) -> None:
        """Refuse two pixels per clock unless they are neighbouring columns and all sync edges are between clocks."""
        screen = config.whole_screen
        if screen.doubling != 1:
            finest = config.scale * screen.doubling
            raise ValueError(
                f"pixels: 2 per clock need one column per pixel of the monitor, {as_typed('scale', finest)}, not "
                f"{config.scale}"
            )
        line = screen.horizontal
        if any(part % 2 for part in (line.visible, line.front, line.sync, line.back)):
            raise ValueError(
                f"pixels: 2 per clock need an even width and blanking, which the {config.screen} screen lacks"
            )
