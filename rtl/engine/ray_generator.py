# SPDX-License-Identifier: MIT
"""The primary ray of a unit's column."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, unsigned
from raycaster.hdl.verbs import less, minus, plus, register, times
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.widths import reached_column_bits, row_bits


@block
def ray_generator(clk, steps, place, column_base, initial_signs, slope, config: Configuration):
    """Generate the slope of the primary ray through a pixel: (view distance, column - centre, horizon - row).

    The slope, in sign and magnitude, is loaded at steps.screen_to_ray. The column is place.column_offset *
    `config.units` + column_base: neighbouring columns are in one group, because their rays mostly hit the same
    rectangles. Every primary ray starts at the camera, which needs no register here.

    Args:
        steps: `Steps`; only screen_to_ray is read.
        place: `Place` of the group; read with steps.screen_to_ray.
        column_base: unsigned, `unit_bits` bits; the unit's column within its group.
        initial_signs: output `Signs`, dx always 0; valid from the cycle after steps.screen_to_ray.
        slope: output `Slope`, the magnitudes, wide enough for the steepest slope on the screen; valid from the cycle
            after steps.screen_to_ray.
    """
    slope_bits = len(slope.dx)
    view_distance = config.screen_geometry.view_distance
    centre_column = config.screen_geometry.centre_column
    horizon_row = config.screen_geometry.horizon_row
    column_width = reached_column_bits(config)

    group_start, scale_offset = times(place.column_offset, config.units, column_width)
    column, add_base = plus(group_start, column_base, column_width)
    dy, centre = minus(column, centre_column, Signed(max(column_width, slope_bits) + 1))
    dz, level = minus(horizon_row, place.row, Signed(max(row_bits(config), slope_bits) + 1))
    (dy_negative, see_y), (dz_negative, see_z) = less(dy, 0), less(dz, 0)
    dy_magnitude, dz_magnitude = unsigned(slope_bits), unsigned(slope_bits)
    dy_size = magnitude(dy, dy_magnitude)
    dz_size = magnitude(dz, dz_magnitude)

    all_signs = initial_signs.joined(dx=False, dy=dy_negative, dz=dz_negative)

    load_slope = register(
        clk, (slope.dx, slope.dy, slope.dz), lambda: (view_distance, dy_magnitude, dz_magnitude), steps.screen_to_ray
    )
    load_signs = register(clk, initial_signs.word, lambda: all_signs, steps.screen_to_ray)

    return instances()
