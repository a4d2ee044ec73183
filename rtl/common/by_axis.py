# SPDX-License-Identifier: MIT
"""A choice by the axis of a rectangle's plane, and the order in which the other two axes come.

a is the plane's own axis. u and v are the other two, in the order x, y, z. p and q are the other two as well: p is the
one along which a ray's slope changes from column to column, for a camera that does not turn: y where possible.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from myhdl import always_comb, block, instances

from raycaster.rtl.common.given import given_verilog

Order = Callable[[Any, Any, Any], Sequence[Any]]
"""Of the components along x, y and z, those that one of these axes has for a plane across x, across y and across z."""


def along_a(x, y, z):
    """The plane's own axis."""
    return x, y, z


def along_u(x, y, z):
    """The first of the other two axes, in the order x, y, z."""
    return y, x, x


def along_v(x, y, z):
    """The second of them."""
    return z, z, y


def along_p(x, y, z):
    """The other axis along which a ray's slope changes from column to column, y where possible."""
    return y, x, y


def along_q(x, y, z):
    """The axis that is left."""
    return z, z, x


@given_verilog(lambda: Path(__file__).with_suffix(".v"), outputs=("chosen",))
@block
def by_axis(axis, on_x, on_y, on_z, chosen, width: int):
    """Choose what belongs to the axis of a rectangle's plane. Combinational.

    Args:
        axis: unsigned, 2 bits; 0, 1, 2 for x, y, z, and don't care at 3.
        on_x: any signal; for a plane across x.
        on_y: as on_x; for a plane across y.
        on_z: as on_x; for a plane across z.
        chosen: output, as on_x.
        width: of each, in bits.
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
