# SPDX-License-Identifier: MIT
"""All widths of the hardware, by name and derived from the configuration."""

from raycaster.configuration import CHANNEL_BITS, COORDINATE_BITS, WORLD_SIZE, Configuration
from raycaster.hdl.signals import bits_for
from raycaster.registers import register_map
from raycaster.scene import CELLS


def field_bits(register: str, field: str) -> int:
    """Width of a register's field, the same in all designs."""
    return register_map(1)[register].fields[field].width


SLOPE_BITS = 9
"""Magnitude of a slope; the sign is stored separately."""

DISTANCE_BITS = COORDINATE_BITS + 1
"""Distance from the camera to a plane, with sign."""

WIDE_BITS = COORDINATE_BITS + 2
"""Distance from the camera to a bound that may be one unit outside the world, with sign: -512..512."""

AXIS_BITS = 2
RGB_BITS = 3 * CHANNEL_BITS
"""A whole colour; the configuration's `colour_bits` is one channel of the VGA output."""

BASIS_BITS = field_bits("forward", "x")
"""A component of the turned camera's basis, times 256, with sign."""

MIRROR_BITS = field_bits("rectangle[0].surface", "mirror")
"""The share that a rectangle mirrors, in quarters: 0..4."""

SHADE_BITS = field_bits("light", "shade")
"""The quarters of a colour that remain in the dark: 0..3."""

REFLECTION_BITS = field_bits("control", "reflections")
"""The number of reflections that a scene asks for."""

KIND_BITS, CELL_BITS = (field_bits("rectangle[0].pattern", name) for name in ("kind", "cell"))
"""A pattern's kind, and log2 of its cell size in world units, minus three."""

SMALLEST_CELL_BITS = CELLS[0].bit_length() - 1
"""log2 of the size of a pattern's smallest cell, in world units."""

PLACE_BITS = COORDINATE_BITS - SMALLEST_CELL_BITS
"""The number of a pattern's cell along an axis."""

WORD_BITS = 32
LANES = 4
"""Bytes of a word, each with its own enable."""

CYCLE_BITS = field_bits("cycles", "row")
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
    return ((WORLD_SIZE - 1) * (config.most_reflections + 1)).bit_length() + 1


def eye_distance_bits(config: Configuration) -> int:
    """Width of the distance from a mirrored eye to a plane ahead of it, without sign."""
    return eye_bits(config) - 1


def walk_bits(config: Configuration) -> int:
    """Width of a product of a slope and a distance within the world, with sign: |n D| <= 511 * the steepest slope."""
    return ((WORLD_SIZE - 1) * steepest_slope(config)).bit_length() + 1


def wide_walk_bits(config: Configuration) -> int:
    """Width of a product of a slope and a distance of `WIDE_BITS`, or of its change per group, with sign."""
    return (WORLD_SIZE * max(steepest_slope(config), config.units)).bit_length() + 1


def share_bits(config: Configuration) -> int:
    """Width of a ray's weight in its pixel: each mirror splits it into quarters or, without materials, into halves."""
    return (2 if config.materials else 1) * config.most_reflections + 1


def unit_bits(config: Configuration) -> int:
    """Width of the number of a ray unit, and of its line buffer section."""
    return bits_for(config.units)


def offset_bits(config: Configuration) -> int:
    """Width of the column offset, which counts the groups of a row, up to Max, one past the last."""
    return bits_for(config.groups + 1)


def row_bits(config: Configuration) -> int:
    """Width of the row counter, which counts up to one past the last row."""
    return bits_for(config.screen_geometry.rows + 1)


def end_bits(columns: int) -> int:
    """Width of a column of a row, or of the column after a run: 0 up to the number of columns."""
    return bits_for(columns + 1)


def column_bits(config: Configuration) -> int:
    """Width of a column of the whole screen, or of the column after a run: 0 up to the number of columns."""
    return end_bits(config.screen_geometry.columns)


def reached_column_bits(config: Configuration) -> int:
    """Width of a column as computed from the column offset, which may be one group past the last."""
    return ((config.groups + 1) * config.units).bit_length()


def signed_slope_bits(config: Configuration) -> int:
    """Width of a component of a slope of the screen, with sign."""
    return exact_slope_bits(config) + 1


def furthest(config: Configuration) -> int:
    """Return the largest factor of a slope in a half-line: a distance from an eye, or of an edge of its last cell.

    A mirrored eye is at most 511 (r + 1) from any coordinate of the world, and a pattern's last edge is at 512.
    """
    return (WORLD_SIZE - 1) * (config.most_reflections + 1) + config.patterns


def line_factor_bits(config: Configuration) -> int:
    """Width of a factor of a slope in a half-line, with sign."""
    return furthest(config).bit_length() + 1


def step_bits(config: Configuration) -> int:
    """Width of the change of a slope's component from column to column, with sign; -1, 0 or 1 unless it turns."""
    return BASIS_BITS if config.turn else 2


def operand_bits(config: Configuration) -> int:
    """Width of a slope component in a half-line, with sign: of a ray, or from the light to a surface."""
    return max(signed_slope_bits(config), (light_slope_bits(config) + 1) if config.light else 0)


def operand_growth_bits(config: Configuration) -> int:
    """Width of the change of a slope's component from column to column, with sign.

    A slope from the light is itself a sum of two products, and changes like the line of a rectangle.
    """
    return max(step_bits(config), line_growth_bits(config) if config.light else 0)


def line_bits(config: Configuration) -> int:
    """Width of A X - B Y - 1, with sign, for two factors and two components of a slope.

    A slope from the light is up to 511 times as steep, but its factors are distances within the world.
    """
    greatest = 2 * furthest(config) * steepest_slope(config)
    if config.light:
        greatest = max(greatest, 2 * (WORLD_SIZE - 1) ** 2 * steepest_slope(config))
    return (greatest + 1).bit_length() + 1


def line_growth_bits(config: Configuration) -> int:
    """Width of the change of A X - B Y from column to column, with sign, for two components of the screen's slope."""
    return (2 * furthest(config) << (step_bits(config) - 1)).bit_length() + 1


def divisor_bits(config: Configuration) -> int:
    """Width of a divisor of `first_change`, with sign: a line's change per column, or the slope at a pattern's cell.

    A line that belongs to the light has components of its slope that change like other lines.
    """
    growth = line_growth_bits(config)
    if config.light:
        growth += (2 * (WORLD_SIZE - 1)).bit_length()
    return max(growth, signed_slope_bits(config)) if config.patterns else growth


def level_bits(config: Configuration) -> int:
    """Width of the number of mirrors that a ray has met."""
    return bits_for(config.most_reflections + 1)


def weight_bits(config: Configuration) -> int:
    """Width of a ray's weight in its pixel, in units of 4 ** -reflections."""
    return 2 * config.most_reflections + 1


def index_bits(config: Configuration) -> int:
    """Width of the number of a rectangle."""
    return bits_for(config.rectangles)


def count_bits(config: Configuration) -> int:
    """Width of a number of entries of a chain, from none to all rectangles."""
    return bits_for(config.rectangles + 1)


def entry_bits(entries: int) -> int:
    """Width of the number of an entry of a list, 0 up to one past the last."""
    return bits_for(entries + 1)


def pixel_bits(config: Configuration) -> int:
    """Width of a pixel as stored for the monitor: red above green above blue."""
    return 3 * config.colour_bits
