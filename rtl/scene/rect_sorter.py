# SPDX-License-Identifier: MIT
"""A rectangle as it was written becomes a rectangle as the engine wants it."""

from myhdl import always_comb, block

from raycaster.configuration import COORDINATE_BITS
from raycaster.registers import register_map
from raycaster.rtl.common.widths import RGB_BITS, unsigned

POINT = register_map(1)["rectangle[0].corner_0"]
X, Y, Z = (POINT.fields[axis] for axis in "xyz")


@block
def rect_sorter(corner_0, corner_1, surface, rect):
    """Find the axis (the first coordinate that both corners share) and put the bounds in order. Combinational.

    The corners may come in any order. Without a plane the result means nothing.
    """
    x_low, x_high = X.lsb, X.lsb + X.width
    y_low, y_high = Y.lsb, Y.lsb + Y.width
    z_low, z_high = Z.lsb, Z.lsb + Z.width
    u_0, u_1, v_0, v_1 = (unsigned(COORDINATE_BITS) for _ in range(4))

    # The plane, and the two other axes in the order x, y, z.
    @always_comb
    def find_axis():
        if corner_0[x_high:x_low] == corner_1[x_high:x_low]:
            rect.axis.next = 0
            rect.position.next = corner_0[x_high:x_low]
            u_0.next = corner_0[y_high:y_low]
            u_1.next = corner_1[y_high:y_low]
            v_0.next = corner_0[z_high:z_low]
            v_1.next = corner_1[z_high:z_low]
        elif corner_0[y_high:y_low] == corner_1[y_high:y_low]:
            rect.axis.next = 1
            rect.position.next = corner_0[y_high:y_low]
            u_0.next = corner_0[x_high:x_low]
            u_1.next = corner_1[x_high:x_low]
            v_0.next = corner_0[z_high:z_low]
            v_1.next = corner_1[z_high:z_low]
        else:
            rect.axis.next = 2
            rect.position.next = corner_0[z_high:z_low]
            u_0.next = corner_0[x_high:x_low]
            u_1.next = corner_1[x_high:x_low]
            v_0.next = corner_0[y_high:y_low]
            v_1.next = corner_1[y_high:y_low]

    # Lower bound first.
    @always_comb
    def sort_u():
        if u_0 <= u_1:
            rect.u_low.next = u_0
            rect.u_high.next = u_1
        else:
            rect.u_low.next = u_1
            rect.u_high.next = u_0

    # Lower bound first.
    @always_comb
    def sort_v():
        if v_0 <= v_1:
            rect.v_low.next = v_0
            rect.v_high.next = v_1
        else:
            rect.v_low.next = v_1
            rect.v_high.next = v_0

    # The colour as it is.
    @always_comb
    def pass_colour():
        rect.colour.next = surface[RGB_BITS:]

    return find_axis, sort_u, sort_v, pass_colour
