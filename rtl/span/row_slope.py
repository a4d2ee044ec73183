# SPDX-License-Identifier: MIT
"""The slope of the first column of row after row."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import Signed, bit
from raycaster.hdl.verbs import minus, register
from raycaster.rtl.common.widths import signed_slope_bits
from raycaster.rtl.span.slope_start import slope_start


@block
def row_slope(clk, first_row, next_row, camera, slope, config: Configuration):
    """Compute the slope of column 0 of a row, for one row after the other.

    It is view distance * forward - centre column * right + (horizon row - row) * up, with the basis of the camera; if
    it does not turn, that divided by 256: (view distance, -centre column, horizon row - row).

    Args:
        first_row: strobe; the rows begin again with row 0.
        next_row: strobe; the row below. Not in the cycle after first_row, nor with it.
        camera: `Camera`; only its basis is read, constant from the cycle before first_row to the last next_row.
        slope: output `Vector` of `signed_slope_bits` bits; valid from the second cycle after first_row, and from the
            cycle after next_row.
    """
    screen = config.screen_geometry
    bits = signed_slope_bits(config)

    if camera.has("forward_x"):
        components = [
            slope_start(
                clk=clk, first_row=first_row, next_row=next_row, forward=forward, right=right, up=up,
                component=component, config=config,
            )
            for forward, right, up, component in (
                (camera.forward_x, camera.right_x, camera.up_x, slope.x),
                (camera.forward_y, camera.right_y, camera.up_y, slope.y),
                (camera.forward_z, camera.right_z, camera.up_z, slope.z),
            )
        ]  # fmt: skip
    else:
        begins = bit()
        below, go_down = minus(slope.z, 1, Signed(bits + 1))

        follow = register(clk, begins, lambda: first_row)

        @always(clk.posedge)
        def step():
            slope.x.next = screen.view_distance
            slope.y.next = -screen.centre_column
            if begins:
                slope.z.next = screen.horizon_row
            elif next_row:
                slope.z.next = below[bits:].signed()

    return instances()
