# SPDX-License-Identifier: MIT
"""A component of the slope of the first column of row after row, for a camera that turns."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, bit, signed
from raycaster.hdl.verbs import assign, minus, register, times


@block
def slope_start(clk, first_row, next_row, forward, right, up, component, config: Configuration):
    """Compute view distance * forward - centre column * right + (horizon row - row) * up, row after row.

    Args:
        first_row: strobe; the rows begin again with row 0.
        next_row: strobe; the row below. Not in the cycle after first_row, nor with it.
        forward: signed, 10 bits; constant from the cycle before first_row on, like right and up.
        right: signed, 10 bits.
        up: signed, 10 bits.
        component: signed output; valid from the second cycle after first_row, and from the cycle after next_row.
    """
    screen = config.screen_geometry
    view_distance, centre_column, horizon_row = screen.view_distance, screen.centre_column, screen.horizon_row
    # One row past the last is legal.
    bits = Signed(len(component) + 2)

    ahead, go_ahead = times(forward, view_distance, bits)
    aside, go_aside = times(right, centre_column, bits)
    above, go_up = times(up, horizon_row, bits)
    below, go_down = minus(component, up, bits)
    ahead_1, aside_1, above_1, whole = (signed(bits) for _ in range(4))
    begins = bit()

    keep_products = register(clk, (begins, ahead_1, aside_1, above_1), lambda: (first_row, ahead, aside, above))

    add = assign(whole, lambda: ahead_1 - aside_1 + above_1)

    @always(clk.posedge)
    def step():
        if begins:
            component.next = whole[len(component) :].signed()
        elif next_row:
            component.next = below[len(component) :].signed()

    return instances()
