# SPDX-License-Identifier: MIT
"""A ray's slope from column to column."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.widths import exact_slope_bits


def ray_slope(aim: Vector, config: Configuration) -> Vector:
    """Return the slope that a `slope_walker` drives; if the camera does not turn, only y changes with the column."""
    slope = Vector(exact_slope_bits(config) + 1)
    if not config.turn:
        slope.x, slope.z = aim.x, aim.z
    return slope


@block
def slope_walker(clk, start_line, step, aim, slope, config: Configuration):
    """Advance a ray's slope D from column to column.

    A step covers as many columns as a clock has pixels.

    Args:
        clk: the clock.
        start_line: strobe; begins a line.
        step: strobe; advances to the next column.
        aim: `Vector`; if the camera turns, the change of D per step, and D is 0 after start_line. Otherwise D of the
            first column, and only D[y] changes.
        slope: `Vector`; output, D. Valid from the cycle after start_line, for the first column, and from the cycle
            after each step, for the next one. If the camera does not turn, x and z are those of aim.
        config: the design.
    """
    columns = config.pixels
    if config.turn:

        @always(clk.posedge)
        def advance():
            if start_line:
                slope.x.next = 0
                slope.y.next = 0
                slope.z.next = 0
            elif step:
                slope.x.next = slope.x + aim.x
                slope.y.next = slope.y + aim.y
                slope.z.next = slope.z + aim.z

    else:

        @always(clk.posedge)
        def advance():
            if start_line:
                slope.y.next = aim.y
            elif step:
                slope.y.next = slope.y + columns

    return instances()
