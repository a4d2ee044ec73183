# SPDX-License-Identifier: MIT
"""Selection by the axis of a rectangle's plane, and the order of the other two axes.

a is the axis that the plane is across. u and v are the other two, in the order x, y, z. p and q are the same two, with
p = y if possible: the axis along which a ray's slope changes from column to column, for a camera that does not turn.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from myhdl import always_comb, block, instances

from raycaster.hdl.given import given_verilog

Order = Callable[[Any, Any, Any], Sequence[Any]]
"""Takes the x, y and z components; returns those along a, u, v, p or q for a plane across x, across y and across z."""


def along_a(x, y, z):
    """Return the components along a, the plane's own axis."""
    return x, y, z


def along_u(x, y, z):
    """Return the components along u, the first of the other two axes in the order x, y, z."""
    return y, x, x


def along_v(x, y, z):
    """Return the components along v, the second of the other two axes in the order x, y, z."""
    return z, z, y


def along_p(x, y, z):
    """Return the components along p, y if possible: the slope along it changes from column to column."""
    return y, x, y


def along_q(x, y, z):
    """Return the components along q, the remaining axis."""
    return z, z, x


@given_verilog(lambda: Path(__file__).with_suffix(".v"), outputs=("chosen",))
@block
def by_axis(axis, on_x, on_y, on_z, chosen, width: int):
    """Select one of three inputs by the axis of a rectangle's plane. Combinational.

    Args:
        axis: unsigned, 2 bits; 0, 1, 2 for x, y, z, and don't care at 3.
        on_x: any signal; selected for a plane across x.
        on_y: like on_x; selected for a plane across y.
        on_z: like on_x; selected for a plane across z.
        chosen: output, like on_x; the selected input.
        width: width of each input and of chosen, in bits.
    """

    @always_comb
    def choose():
        if axis == 0:
            chosen.next = on_x
        elif axis == 1:
            chosen.next = on_y
        else:
            chosen.next = on_z

    return instances()
