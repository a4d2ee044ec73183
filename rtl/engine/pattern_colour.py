# SPDX-License-Identifier: MIT
"""The colour of a patterned rectangle at a point."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign


@block
def pattern_colour(look, odd_u, odd_v, colour):
    """Choose between the two colours of a pattern. Combinational.

    A checker takes the second colour if exactly one of odd_u and odd_v is high, rows if odd_v is, columns if odd_u is.

    Args:
        look: record with the fields of a `Look` with patterns.
        odd_u: flag; the lowest bit of floor(P[u] / cell), P the hit point.
        odd_v: flag; the lowest bit of floor(P[v] / cell).
        colour: unsigned output, 24 bits; the colour of the point.
    """
    second = bit()

    @always_comb
    def choose_cell():
        second.next = False
        if look.kind == 1:
            second.next = odd_u != odd_v
        elif look.kind == 2:
            second.next = odd_v
        elif look.kind == 3:
            second.next = odd_u

    choose_colour = assign(colour, lambda: look.colour_2 if second else look.colour)

    return instances()
