# SPDX-License-Identifier: MIT
"""The engine that tests all rectangles at once, a pixel a clock, just as the monitor takes them.

The blocks in `raycaster.rtl.beam` take their latencies from here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from raycaster.engines.engine import SETUP_LATENCY, SMALLEST_CELL_BITS, Engine
from raycaster.screens import BEAM_SCREENS, COORDINATE_BITS, Screen

if TYPE_CHECKING:
    from raycaster.configuration import Configuration, Options

AIM_LATENCY = 5
"""Cycles from start_line to the first ray."""

ENTRY_LATENCY = 1
"""Cycles from next_column to the first walkers' step."""

TESTER_LATENCY = 3
"""Cycles from the way to the hit, of ray_tester and of fold_tester."""

FOLD_LATENCY = 3
"""Cycles of ray_fold."""

LOOK_UP_LATENCY = 1
"""Cycles from a winner to its facet and its surface."""

CELL_SLOPE_AT = 2
"""Cycles from the winner to the slope's magnitudes, as hit_cells reads them."""

CELL_LATENCY = CELL_SLOPE_AT + 3 + COORDINATE_BITS - SMALLEST_CELL_BITS
"""Cycles from a winner to the cells of its pattern: products and their sum, then a bit of the quotient a cycle."""

SEEN_LATENCY = MEAN_LATENCY = MIX_LATENCY = 1
"""Cycles of colour_seen, colour_mean and colour_mix."""


def rounds(config: Configuration) -> int:
    """Rounds in which the nearest of a pass's rectangles is found, two by two; one alone has one too."""
    most = max(mask.bit_count() for mask in config.passes)
    return max(1, (most - 1).bit_length())


def contest_latency(config: Configuration) -> int:
    """Cycles of a round; where wires are long, what the multipliers put out has one for its way."""
    return 3 if config.has_long_wires else 2


def winner_latency(config: Configuration) -> int:
    """Cycles from a pass's ray to the rectangle that it sees."""
    return TESTER_LATENCY + rounds(config) * contest_latency(config)


def is_staged(config: Configuration) -> bool:
    """Whether what a tester chooses of the fold and of the slope is registered.

    It is where the camera turns, as all is wider, and where wires are long.
    """
    return config.turn or config.has_long_wires


def fold_lead(config: Configuration) -> int:
    """Cycles from the fold to the way."""
    return 1 if is_staged(config) else 0


def slope_at(config: Configuration) -> int:
    """Cycles from the way to the slope's magnitudes."""
    return 1 if is_staged(config) else 2


def pass_latency(config: Configuration) -> int:
    """Cycles from a ray to its reflection."""
    return winner_latency(config) + LOOK_UP_LATENCY + FOLD_LATENCY + fold_lead(config)


def cell_latency(config: Configuration) -> int:
    """Cycles from a winner to the cells of its pattern that it is hit in."""
    return CELL_LATENCY if config.patterns else 0


def mixes(config: Configuration) -> bool:
    """Whether mirrors may show more or less than half."""
    return config.materials and config.reflections > 0


def blend_latency(config: Configuration) -> int:
    """Cycles from what was seen to the pixel."""
    return SEEN_LATENCY + (config.reflections * MIX_LATENCY if mixes(config) else MEAN_LATENCY)


def tested(config: Configuration) -> list[list[int]]:
    """For the primary ray and each reflection, the numbers of the rectangles that it is tested against.

    A fixed scene may leave none for a reflection, which is then none; one rectangle is always tested.
    """
    return [[i for i in range(config.rectangles) if mask >> i & 1] for mask in config.passes if mask]


def beam_latency(config: Configuration) -> int:
    """Cycles from next_column to the column's colour."""
    reflections = len(tested(config)) - 1
    entered = ENTRY_LATENCY + reflections * pass_latency(config)
    return entered + winner_latency(config) + cell_latency(config) + LOOK_UP_LATENCY + blend_latency(config)


def start_cycles(config: Configuration) -> int:
    """Cycles from start_line until the first column may come."""
    if not config.turn:
        # Two lanes' starts are registered by themselves.
        return SETUP_LATENCY + config.rectangles + config.pixels - 1
    # A sweep reads its slope from the third cycle on, and the next one starts with its last load.
    return AIM_LATENCY - 3 + (config.pixels + 1) * (SETUP_LATENCY + config.rectangles - 1) + 1


def blanking_left(config: Configuration) -> int:
    """Cycles of a line's blanking that are left when its first column starts; negative where it comes too late."""
    horizontal = config.screen_geometry.beats
    # The horizontal sync is seen a pixel after its turn, and the columns start before theirs.
    return horizontal.blank - horizontal.front - beam_latency(config) - 1 - start_cycles(config)


class Beam(Engine):
    """A lane for each pixel of a clock, without a line buffer."""

    name, code = "beam", 2
    colour, marker = "#009E73", "^"
    usual_build = "25 s"
    screens = BEAM_SCREENS
    rect_latency = 2
    line_buffered = False
    lacks: ClassVar = {"light": "the beam engine would need some 72 more products for each ray of a clock"}

    def scales(self, screen: Screen) -> tuple[int, ...]:
        """All that the monitor has pixels for, the finest first."""
        return tuple(sorted(screen.scales, key=lambda scale: scale != screen.doubling))

    def refuse(self, options: Options) -> None:
        """Refuse culling, and units that are not its lanes."""
        super().refuse(options)
        if options.culling:
            raise ValueError("culling: the beam engine takes all rectangles at once; leave it out")
        if options.units not in (None, options.pixels):
            raise ValueError(
                f"units: the beam engine has one for each of PIXELS={options.pixels} a clock, not {options.units}"
            )

    def sized(self, config: Configuration, options: Options) -> Configuration:
        """Take a lane for each pixel of a clock."""
        if config.pixels > 1:
            self._check_pairs(config)
        return replace(config, units=config.pixels)

    def describe(self, config: Configuration) -> str:
        """Screen and lanes."""
        screen = config.screen_geometry
        return f"beam {screen.columns}x{screen.rows}" + (", 2 pixels a clock" if config.pixels == 2 else "")

    def label(self, config: Configuration) -> str:
        """Rows and lanes."""
        return f"{config.screen_geometry.rows}p" + (" x2" if config.pixels == 2 else "")

    def slot_cycles(self, config: Configuration) -> int:
        """It takes all rectangles at once."""
        return 0

    def pass_latency(self, config: Configuration) -> int:
        """Each clock begins every pass."""
        return 0

    def group_cycles(self, config: Configuration) -> int:
        """A group is a clock's pixels."""
        return 1

    def check(self, config: Configuration) -> None:
        """See that a line is set up while the monitor is in its blanking."""
        if (left := blanking_left(config)) >= 0:
            return
        turning = " and a camera that turns" if config.turn else ""
        paired = " at two pixels a clock" if config.pixels > 1 else ""
        ways = ["take fewer of either", *(["TURN=0"] if turning else []), *(["PIXELS=1"] if paired else [])]
        raise ValueError(
            f"rectangles: with {config.rectangles} of them, {config.reflections} reflections{turning}{paired}, the "
            f"beam engine is {-left} cycles short of a line's blanking on this screen; {' or '.join(ways)}"
        )

    @staticmethod
    def _check_pairs(config: Configuration) -> None:
        """Two pixels a clock are two neighbouring columns, and both edges of each sync are between two clocks."""
        screen = config.whole_screen
        if screen.doubling != 1:
            finest = config.scale * screen.doubling
            raise ValueError(
                f"pixels: 2 a clock need a column for each of the monitor's pixels, SCALE={finest}, not {config.scale}"
            )
        line = screen.horizontal
        if any(part % 2 for part in (line.visible, line.front, line.sync, line.back)):
            raise ValueError(
                f"pixels: 2 a clock need an even width and blanking, and the {config.screen} screen's are not"
            )
