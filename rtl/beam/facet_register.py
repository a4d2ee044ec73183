# SPDX-License-Identifier: MIT
"""What all columns of a row have in common, for one rectangle."""

from myhdl import always, block


@block
def facet_register(clk, load, new_facet, new_growth, facet, growth):
    """Keep a rectangle's facet and growth from load to load."""

    # Loaded once a line.
    @always(clk.posedge)
    def keep():
        if load:
            facet.usable.next = new_facet.usable
            facet.axis.next = new_facet.axis
            facet.distance.next = new_facet.distance
            facet.way_v.next = new_facet.way_v
            facet.colour.next = new_facet.colour
            growth.way_u.next = new_growth.way_u
            growth.low_u.next = new_growth.low_u
            growth.high_u.next = new_growth.high_u
            growth.low_v.next = new_growth.low_v
            growth.high_v.next = new_growth.high_v

    return keep
