# SPDX-License-Identifier: MIT
"""A slope component of a primary ray, for a camera that turns."""

from myhdl import block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, signed, unsigned
from raycaster.hdl.verbs import less, plus, register, times
from raycaster.rtl.common.magnitude import magnitude


@block
def slope_component(
    clk, steps, forward, right, up, column, row, column_base, size, negative, config: Configuration
):  # fmt: skip
    """Compute view distance * forward + (column + column_base) * right + row * up, in sign and magnitude.

    It is loaded at steps.screen_to_ray. column_base never changes; all other inputs must be stable from the cycle
    before that on.

    Args:
        steps: `Steps`; only screen_to_ray is read.
        forward: signed, 10 bits; a component of the camera's forward vector, times 256.
        right: signed, 10 bits; that component of the camera's right vector, times 256.
        up: signed, 10 bits; that component of the camera's up vector, times 256.
        column: signed; columns from the screen's centre to the first unit's column, to the right.
        row: signed; rows above the horizon.
        column_base: unsigned, `unit_bits` bits; the unit's column within its group, constant.
        size: unsigned output, wide enough for the steepest slope on the screen; the magnitude. Valid from the cycle
            after steps.screen_to_ray.
        negative: output flag, the sign; valid from the cycle after steps.screen_to_ray.
    """
    view_distance = config.screen_geometry.view_distance
    # A group past the last one is legal, though nothing is loaded there: twice the steepest slope is more than enough.
    bits = Signed(len(size) + 2)

    ahead, go_ahead = times(forward, view_distance, bits)
    across, go_across = times(right, column, bits)
    upward, go_up = times(up, row, bits)
    aside, go_aside = times(right, column_base, bits)
    level, add_columns = plus(ahead, across, bits)
    total, add_rows = plus(level, upward, bits)
    start, component_size = signed(bits), unsigned(len(size))
    component, add_aside = plus(start, aside, bits)
    component_negative, take_sign = less(component, 0)
    absolute = magnitude(component, component_size)

    # start is the same in all units, so synthesis keeps one of them.
    keep_start = register(clk, start, lambda: total)

    load = register(clk, (size, negative), lambda: (component_size, component_negative), steps.screen_to_ray)

    return instances()
