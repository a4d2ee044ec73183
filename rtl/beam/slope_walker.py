# SPDX-License-Identifier: MIT
"""The component of the slope that the column changes."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration


@block
def slope_walker(clk, start_line, step, column_slope, config: Configuration):
    """column_slope: D[y] = column - centre, two's complement, of the first column after start_line; step: the next."""
    first_slope = -config.screen_geometry.centre_column

    @always(clk.posedge)
    def advance():
        if start_line:
            column_slope.next = first_slope
        elif step:
            column_slope.next = column_slope + 1

    return instances()
