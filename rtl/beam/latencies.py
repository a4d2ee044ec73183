# SPDX-License-Identifier: MIT
"""Latencies of the beam engine's blocks, which take them from here."""

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.rtl.common.widths import SMALLEST_CELL_BITS
from raycaster.rtl.engine.rect_setup import SETUP_LATENCY

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
