# SPDX-License-Identifier: MIT
"""The primary ray of a unit's column."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import row_bits, signed, unsigned


@block
def ray_generator(clk, steps, row, column_base, column_offset, initial_signs, slope, config: Configuration):
    """Slope of the ray through (row, column): (100, column - centre, horizon - row), in sign and magnitude.

    The column is column_offset * units + column_base: neighbours in one group share their fate. Loaded at
    steps.screen_to_ray. Every primary ray starts at the camera, which needs no register here. slope: wide enough for
    the screen's steepest.
    """
    slope_bits = len(slope.dx)
    units = config.units
    view_distance = config.screen_geometry.view_distance
    centre_column = config.screen_geometry.centre_column
    horizon_row = config.screen_geometry.horizon_row
    # One group past the last is legal: the counter rests there.
    column_width = (config.groups * units + units).bit_length()

    group_start = unsigned(column_width)
    column = unsigned(column_width)
    dy, opposite_dy = (signed(max(column_width, slope_bits) + 1) for _ in range(2))
    dz, opposite_dz = (signed(max(row_bits(config), slope_bits) + 1) for _ in range(2))
    dy_magnitude, dz_magnitude = unsigned(slope_bits), unsigned(slope_bits)

    # The group's first column.
    @always_comb
    def scale_offset():
        group_start.next = column_offset * units

    # This unit's column.
    @always_comb
    def add_base():
        column.next = group_start + column_base

    # Slopes to the side and up.
    @always_comb
    def centre():
        dy.next = column - centre_column
        dz.next = horizon_row - row

    # And the other way.
    @always_comb
    def negate():
        opposite_dy.next = -dy
        opposite_dz.next = -dz

    # A reflection flips the sign and the divider wants the magnitude.
    @always_comb
    def take_magnitudes():
        if dy < 0:
            dy_magnitude.next = opposite_dy[slope_bits:]
        else:
            dy_magnitude.next = dy[slope_bits:]
        if dz < 0:
            dz_magnitude.next = opposite_dz[slope_bits:]
        else:
            dz_magnitude.next = dz[slope_bits:]

    # Keep the ray.
    @always(clk.posedge)
    def load():
        if steps.screen_to_ray:
            slope.dx.next = view_distance
            slope.dy.next = dy_magnitude
            slope.dz.next = dz_magnitude
            initial_signs.dx.next = False
            initial_signs.dy.next = dy < 0
            initial_signs.dz.next = dz < 0

    return scale_offset, add_base, centre, negate, take_magnitudes, load
