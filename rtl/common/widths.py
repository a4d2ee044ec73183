# SPDX-License-Identifier: MIT
"""All widths of the hardware, by name and derived from the configuration."""

from raycaster.configuration import CHANNEL_BITS, COORDINATE_BITS, WORLD_SIZE, Configuration
from raycaster.hdl.signals import bits_for
from raycaster.scene import PATTERNS

SLOPE_BITS = 9
"""Magnitude of a slope; the sign is stored separately."""

DISTANCE_BITS = COORDINATE_BITS + 1
"""Distance from the camera to a plane, with sign."""

WIDE_BITS = COORDINATE_BITS + 2
"""Distance from the camera to a bound that may be one unit outside the world, with sign: -512..512."""

AXIS_BITS = 2
RGB_BITS = 3 * CHANNEL_BITS
"""A whole colour; the configuration's `colour_bits` is one channel of the VGA output."""

BASIS_BITS = 10
"""A component of the turned camera's basis, times 256, with sign."""

MIRROR_BITS = 3
"""The share that a rectangle mirrors, in quarters: 0..4."""

SHADE_BITS = 2
"""The quarters of a colour that remain in the dark: 0..3."""

REFLECTION_BITS = 3
"""The number of reflections that a scene asks for."""

KIND_BITS = (len(PATTERNS) - 1).bit_length()
CELL_BITS = 3
"""A pattern's kind, and log2 of its cell size in world units, minus three."""

SMALLEST_CELL_BITS = 3
"""log2 of the size of a pattern's smallest cell, in world units."""

WORD_BITS = 32
LANES = 4
"""Bytes of a word, each with its own enable."""

CYCLE_BITS = 16
"""Width of the counters that measure the row budget."""


def position_bits(config: Configuration) -> int:
    """Width of origins, planes, distances, quotients and hit points: 9 bits and the fraction."""
    return COORDINATE_BITS + config.fraction_bits


def product_bits(config: Configuration) -> int:
    """Width of the dividend, |b * (c - d)|."""
    return SLOPE_BITS + position_bits(config)


def slope_factors(config: Configuration) -> tuple[int, int, int]:
    """Return the largest slope on each camera axis: view distance, most columns and most rows from the centre."""
    screen = config.screen_geometry
    return screen.view_distance, screen.centre_column, max(screen.horizon_row, screen.rows - 1 - screen.horizon_row)


def factor_bits(config: Configuration) -> int:
    """Width of the greatest slope factor, with sign."""
    return max(slope_factors(config)).bit_length() + 1


def steepest_slope(config: Configuration) -> int:
    """Return the largest magnitude of a slope component on the screen, for any basis that the registers can hold."""
    factors = slope_factors(config)
    return sum(factors) << (BASIS_BITS - 1) if config.turn else max(factors)


def exact_slope_bits(config: Configuration) -> int:
    """Width of the magnitude of the steepest slope on the screen, for engines that need no more."""
    return steepest_slope(config).bit_length()


def light_slope_bits(config: Configuration) -> int:
    """Width of the magnitude of a shadow ray's slope.

    S = e (P - L) with P and L in the world, so it is at most 511 times the steepest slope.
    """
    return ((WORLD_SIZE - 1) * steepest_slope(config)).bit_length()


def eye_bits(config: Configuration) -> int:
    """Width of a mirrored eye's coordinate and distance from any plane, with sign: each mirror adds a world's width.

    E' = 2k - E: r mirrors take the camera's 0..511 to -511 r .. 511 (r + 1), which is at most 511 (r + 1) from any
    coordinate of the world.
    """
    return ((WORLD_SIZE - 1) * (config.reflections + 1)).bit_length() + 1


def walk_bits(config: Configuration) -> int:
    """Width of a product of a slope and a distance within the world, with sign: |n D| <= 511 * the steepest slope."""
    return ((WORLD_SIZE - 1) * steepest_slope(config)).bit_length() + 1


def wide_walk_bits(config: Configuration) -> int:
    """Width of a product of a slope and a distance of `WIDE_BITS`, or of its change per group, with sign."""
    return (WORLD_SIZE * max(steepest_slope(config), config.units)).bit_length() + 1


def shift_bits(config: Configuration) -> int:
    """Width of a component of T (see `ray_fold`), with sign: mirrors on an axis add and subtract twice their distances.

    In pairs they cancel the camera's position, so each pair, or a single mirror, contributes at most 2 * 511.
    """
    pairs = max(1, (config.reflections + 1) // 2)
    return (2 * (WORLD_SIZE - 1) * pairs).bit_length() + 1


def fold_bits(config: Configuration) -> int:
    """Width of a product at the folded ray, with sign.

    It is the sum of (n - T[a]) D[u] and T[u] D[a]. One mirror makes one component of T nonzero, more make both. T has
    `shift_bits`, so |T| <= t = 1 << (shift_bits - 1), and the sum is at most (511 + m t) * the steepest slope, with
    m = 1 for one mirror and m = 2 for more.
    """
    offsets = min(config.reflections, 2) << (shift_bits(config) - 1)
    return ((WORLD_SIZE - 1 + offsets) * steepest_slope(config)).bit_length() + 1


def share_bits(config: Configuration) -> int:
    """Width of a ray's weight in its pixel: each mirror splits it into quarters or, without materials, into halves."""
    return (2 if config.materials else 1) * config.reflections + 1


def unit_bits(config: Configuration) -> int:
    """Width of the number of a ray unit, and of its line buffer section."""
    return bits_for(config.units)


def offset_bits(config: Configuration) -> int:
    """Width of the column offset, which counts the groups of a row, up to Max, one past the last."""
    return bits_for(config.groups + 1)


def row_bits(config: Configuration) -> int:
    """Width of the row counter, which counts up to one past the last row."""
    return bits_for(config.screen_geometry.rows + 1)


def index_bits(config: Configuration) -> int:
    """Width of the number of a rectangle."""
    return bits_for(config.rectangles)


def pixel_bits(config: Configuration) -> int:
    """Width of a pixel as stored for the monitor: red above green above blue."""
    return 3 * config.colour_bits
