# SPDX-License-Identifier: MIT
"""The colour of a rectangle with a pattern at one of its points."""

from myhdl import always_comb, block, instances

from raycaster.rtl.common.widths import bit


@block
def pattern_colour(look, odd_u, odd_v, colour):
    """colour: look's colour or its second one, 24 bits. Combinational.

    look: a record with the fields of a `Look` with patterns; odd_u, odd_v: the lowest bit of floor(P[u] / cell) and
    of floor(P[v] / cell). A checker takes the second colour where one of them is odd, rows where v is, columns where u.
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

    @always_comb
    def choose_colour():
        if second:
            colour.next = look.colour_2
        else:
            colour.next = look.colour

    return instances()
