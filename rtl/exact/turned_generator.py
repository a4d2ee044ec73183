# SPDX-License-Identifier: MIT
"""The primary ray of a unit's column, for a camera that turns."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, bit
from raycaster.hdl.verbs import assign, minus, times
from raycaster.rtl.common.widths import reached_column_bits, row_bits
from raycaster.rtl.exact.slope_component import slope_component


@block
def turned_generator(
    clk, steps, place, column_base, camera, initial_signs, slope, config: Configuration
):  # fmt: skip
    """Generate the primary ray of a unit's column, for a camera that turns.

    The block replaces ray_generator, and has the same ports and a camera. The slope, in sign and magnitude, is view
    distance * forward + (column - centre) * right + (horizon - row) * up, and 256 times as long as with a camera that
    does not turn. The column is place.column_offset * `config.units` + column_base.

    Args:
        steps: `Steps`; only screen_to_ray is read, at which the ray is loaded.
        place: `Place` of the group; stable from the cycle before steps.screen_to_ray on.
        column_base: unsigned, `unit_bits` bits; the unit's column within its group, constant.
        camera: `Camera`; only its basis is read, stable from the cycle before steps.screen_to_ray on.
        initial_signs: output `Signs`; valid from the cycle after steps.screen_to_ray.
        slope: output `Slope`, the magnitudes, wide enough for the steepest slope on the screen; valid from the cycle
            after steps.screen_to_ray.
    """
    screen = config.screen_geometry
    centre_column, horizon_row = screen.centre_column, screen.horizon_row
    column_width = reached_column_bits(config)

    group_start, scale_offset = times(place.column_offset, config.units, column_width)
    column, centre = minus(group_start, centre_column, Signed(column_width + 1))
    row, level = minus(horizon_row, place.row, Signed(row_bits(config) + 1))
    negative_x, negative_y, negative_z = bit(), bit(), bit()

    along_x = slope_component(
        clk=clk, steps=steps, forward=camera.forward_x, right=camera.right_x, up=camera.up_x, column=column, row=row,
        column_base=column_base, size=slope.dx, negative=negative_x, config=config,
    )  # fmt: skip
    along_y = slope_component(
        clk=clk, steps=steps, forward=camera.forward_y, right=camera.right_y, up=camera.up_y, column=column, row=row,
        column_base=column_base, size=slope.dy, negative=negative_y, config=config,
    )  # fmt: skip
    along_z = slope_component(
        clk=clk, steps=steps, forward=camera.forward_z, right=camera.right_z, up=camera.up_z, column=column, row=row,
        column_base=column_base, size=slope.dz, negative=negative_z, config=config,
    )  # fmt: skip

    all_signs = initial_signs.joined(dx=negative_x, dy=negative_y, dz=negative_z)
    join_signs = assign(initial_signs.word, lambda: all_signs)

    return instances()
