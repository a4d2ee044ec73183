# SPDX-License-Identifier: MIT
"""Every width of the hardware, derived from the configuration by name, and signals of those widths."""

from myhdl import ConcatSignal, Signal, intbv
from myhdl._Signal import _Signal

from raycaster.configuration import CHANNEL_BITS, COORDINATE_BITS, WORLD_SIZE, Configuration
from raycaster.scene import PATTERNS

SLOPE_BITS = 9
"""Magnitude of a slope; the sign is kept beside it."""

DISTANCE_BITS = COORDINATE_BITS + 1
"""From the camera to a plane, with the sign."""

WIDE_BITS = COORDINATE_BITS + 2
"""From the camera to a bound that may be a unit outside the world, with the sign: -512..512."""

AXIS_BITS = 2
RGB_BITS = 3 * CHANNEL_BITS
"""A whole colour; `colour_bits` of a configuration is a channel of the VGA output."""

BASIS_BITS = 10
"""A component of the turned camera's basis, times 256, with the sign."""

MIRROR_BITS = 3
"""How much a rectangle mirrors, in quarters: 0..4."""

SHADE_BITS = 2
"""Width of a shade: the quarters of a colour that are left in the dark, 0..3."""

REFLECTION_BITS = 3
"""How many reflections a scene asks for."""

KIND_BITS = (len(PATTERNS) - 1).bit_length()
CELL_BITS = 3
"""Of a pattern: its kind, and log2 of a cell's size in world units, less three."""

WORD_BITS = 32
LANES = 4
"""Bytes of a word, each of which has an enable of its own."""

CYCLE_BITS = 16
"""Of the counters that measure the row budget."""


def bits_for(count: int) -> int:
    """Width of a counter with this many values; a signal has at least one bit."""
    return max(1, (count - 1).bit_length())


def position_bits(config: Configuration) -> int:
    """Origins, planes, distances, quotients and hit points: 9 bits and the fraction."""
    return COORDINATE_BITS + config.fraction_bits


def product_bits(config: Configuration) -> int:
    """|b * (c - d)|, the dividend."""
    return SLOPE_BITS + position_bits(config)


def slope_factors(config: Configuration) -> tuple[int, int, int]:
    """The view distance, and the most columns and rows from the centre: a slope along the camera's own axes."""
    screen = config.screen_geometry
    return screen.view_distance, screen.centre_column, max(screen.horizon_row, screen.rows - 1 - screen.horizon_row)


def factor_bits(config: Configuration) -> int:
    """The greatest of them, with the sign."""
    return max(slope_factors(config)).bit_length() + 1


def steepest_slope(config: Configuration) -> int:
    """The largest magnitude of a slope's component on the screen, for any basis that the registers can hold."""
    factors = slope_factors(config)
    return sum(factors) << (BASIS_BITS - 1) if config.turn else max(factors)


def exact_slope_bits(config: Configuration) -> int:
    """Magnitude of the steepest slope on the screen, for the engines that need no more."""
    return steepest_slope(config).bit_length()


def light_slope_bits(config: Configuration) -> int:
    """Magnitude of the slope of a ray from the light.

    S = e (P - L) with P and L in the world, so it is at most 511 times the steepest slope.
    """
    return ((WORLD_SIZE - 1) * steepest_slope(config)).bit_length()


def eye_bits(config: Configuration) -> int:
    """A mirrored eye's coordinate, and its distance from any plane, with the sign: each mirror adds a world's width.

    E' = 2k - E: from 0..511 of the camera, r mirrors lead to -511 r .. 511 (r + 1), which is no further than that from
    any coordinate of the world.
    """
    return ((WORLD_SIZE - 1) * (config.reflections + 1)).bit_length() + 1


def walk_bits(config: Configuration) -> int:
    """A product of a slope and a distance within the world, with the sign: |n D| <= 511 * the steepest slope."""
    return ((WORLD_SIZE - 1) * steepest_slope(config)).bit_length() + 1


def wide_walk_bits(config: Configuration) -> int:
    """The same with a distance of `WIDE_BITS`, or what that grows by from one group to the next."""
    return (WORLD_SIZE * max(steepest_slope(config), config.units)).bit_length() + 1


def turn_bits(config: Configuration) -> int:
    """A component of T (see `ray_fold`), with the sign: mirrors on one axis add and take away twice their distances.

    Two by two they cancel the camera, so each pair, or one alone, adds up to 2 * 511.
    """
    pairs = max(1, (config.reflections + 1) // 2)
    return (2 * (WORLD_SIZE - 1) * pairs).bit_length() + 1


def fold_bits(config: Configuration) -> int:
    """A product at the folded ray, with the sign.

    (n - T[a]) D[u] and T[u] D[a] add up, where one mirror makes one component of T not 0, and more make both. T is kept
    in `turn_bits`, so |T| <= t = 1 << (turn_bits - 1), and |.| <= (511 + m t) * the steepest slope, with m = 1 of one
    mirror and m = 2 of more.
    """
    offsets = min(config.reflections, 2) << (turn_bits(config) - 1)
    return ((WORLD_SIZE - 1 + offsets) * steepest_slope(config)).bit_length() + 1


def share_bits(config: Configuration) -> int:
    """How much a ray's colour weighs in its pixel: each mirror splits it into quarters, or all split it into halves."""
    return (2 if config.materials else 1) * config.reflections + 1


def unit_bits(config: Configuration) -> int:
    """The number of a ray unit, and of its line buffer section."""
    return bits_for(config.units)


def offset_bits(config: Configuration) -> int:
    """The column offset counts the groups of a row, and Max, which is one past the last."""
    return bits_for(config.groups + 1)


def row_bits(config: Configuration) -> int:
    """The row counter counts the rows, and one past the last."""
    return bits_for(config.screen_geometry.rows + 1)


def index_bits(config: Configuration) -> int:
    """The number of a rectangle."""
    return bits_for(config.rectangles)


def pixel_bits(config: Configuration) -> int:
    """A pixel as it is stored for the monitor: red above green above blue."""
    return 3 * config.colour_bits


def unsigned(width: int) -> _Signal:
    """An unsigned signal, 0 at first."""
    return Signal(intbv(0)[width:])


def signed(width: int) -> _Signal:
    """A two's complement signal, 0 at first."""
    return Signal(intbv(0, min=-(1 << (width - 1)), max=1 << (width - 1)))


def bit() -> _Signal:
    """A signal of one bit, low at first."""
    return Signal(bool(0))


def side_by_side(signals: list) -> _Signal:
    """The signals as one vector, the first in the lowest bits."""
    return ConcatSignal(*reversed(signals)) if len(signals) > 1 else signals[0]
