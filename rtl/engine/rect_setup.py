# SPDX-License-Identifier: MIT
"""What neighbouring columns of a row start from, for one rectangle after another."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    DISTANCE_BITS,
    RGB_BITS,
    bit,
    exact_slope_bits,
    index_bits,
    signed,
    unsigned,
)

LATENCY = 5
"""Cycles from start_line to the first load, beside one for each rectangle."""


@block
def rect_setup(
    clk,
    reset,
    start_line,
    rects,
    camera,
    column_slope,
    row_slope,
    load,
    facet,
    growth,
    start,
    config: Configuration,
):
    """From start_line on, take a rectangle a cycle from memory; LATENCY cycles later it stands at the outputs.

    Six products of a distance and a component of the ray through the first column (Kensler and Shirley 2006); along the
    row they grow linearly, so no later column needs one (forward differences). load: a bit for each rectangle, high
    where the outputs are its own; facet, start: as in `interfaces`; growth: what a column adds to start. rects:
    PipelinedRects, whose bounds may have a sign. column_slope, row_slope: D[y] of the first column and D[z], which hold
    still from the third cycle after start_line. reset: synchronous. Widths of distances to bounds are growth's, those
    of products start's.
    """
    slope_bits = exact_slope_bits(config) + 1
    bound_bits = len(growth.low_u)
    way_v_bits, product_bits = len(facet.way_v), len(start.way_u)
    last = config.rectangles - 1
    view_distance = config.screen_geometry.view_distance

    reading, asked, at_hand = bit(), bit(), bit()
    number = unsigned(index_bits(config))
    usable_0, usable = bit(), bit()
    eye_a, plane, distance = (signed(DISTANCE_BITS) for _ in range(3))
    eye_u, eye_v, low_u, high_u, low_v, high_v = (signed(bound_bits) for _ in range(6))
    slope_a, slope_u, slope_v = (signed(slope_bits) for _ in range(3))
    to_low_u, to_high_u, to_low_v, to_high_v = (signed(bound_bits) for _ in range(4))

    number_0, number_1, number_2 = (unsigned(index_bits(config)) for _ in range(3))
    at_hand_2, usable_2 = bit(), bit()
    axis_2 = unsigned(AXIS_BITS)
    colour_2 = unsigned(RGB_BITS)
    distance_2 = signed(DISTANCE_BITS)
    to_low_u_2, to_high_u_2, to_low_v_2, to_high_v_2 = (signed(bound_bits) for _ in range(4))
    slope_a_2, slope_u_2, slope_v_2 = (signed(slope_bits) for _ in range(3))
    way_v = signed(way_v_bits)
    way_u, way_low_u, way_high_u, way_low_v, way_high_v = (signed(product_bits) for _ in range(5))

    # One rectangle after another.
    @always(clk.posedge)
    def count():
        if reset:
            reading.next = False
        elif start_line:
            reading.next = True
            number.next = 0
        elif reading:
            if number == last:
                reading.next = False
            else:
                number.next = number + 1

    # Ask for it.
    @always_comb
    def fetch():
        rects.fetch.next = reading
        rects.index.next = number

    # It comes two cycles later, and its distances one after that.
    @always(clk.posedge)
    def follow():
        asked.next = reading and not reset
        at_hand.next = asked and not reset
        at_hand_2.next = at_hand and not reset

    # Which one it is, and whether it may be hit.
    @always(clk.posedge)
    def identify():
        number_0.next = number
        number_1.next = number_0
        number_2.next = number_1
        usable_0.next = rects.usable[number]
        usable.next = usable_0
        usable_2.next = usable

    # The camera, the bounds and the ray as the rectangle's axis sees them.
    @always_comb
    def choose_axes():
        plane.next = rects.rect.position
        if rects.rect.axis == 0:
            eye_a.next = camera.x
            eye_u.next = camera.y
            eye_v.next = camera.z
            slope_a.next = view_distance
            slope_u.next = column_slope
            slope_v.next = row_slope
        elif rects.rect.axis == 1:
            eye_a.next = camera.y
            eye_u.next = camera.x
            eye_v.next = camera.z
            slope_a.next = column_slope
            slope_u.next = view_distance
            slope_v.next = row_slope
        else:
            eye_a.next = camera.z
            eye_u.next = camera.y
            eye_v.next = camera.x
            slope_a.next = row_slope
            slope_u.next = column_slope
            slope_v.next = view_distance
        if rects.rect.axis == 2:
            low_u.next = rects.rect.v_low
            high_u.next = rects.rect.v_high
            low_v.next = rects.rect.u_low
            high_v.next = rects.rect.u_high
        else:
            low_u.next = rects.rect.u_low
            high_u.next = rects.rect.u_high
            low_v.next = rects.rect.v_low
            high_v.next = rects.rect.v_high

    # From the camera to the plane and to each bound.
    @always_comb
    def measure():
        distance.next = plane - eye_a
        to_low_u.next = low_u - eye_u
        to_high_u.next = high_u - eye_u
        to_low_v.next = low_v - eye_v
        to_high_v.next = high_v - eye_v

    # Everything that is multiplied.
    @always(clk.posedge)
    def hold_distances():
        axis_2.next = rects.rect.axis
        colour_2.next = rects.rect.colour
        distance_2.next = distance
        to_low_u_2.next = to_low_u
        to_high_u_2.next = to_high_u
        to_low_v_2.next = to_low_v
        to_high_v_2.next = to_high_v
        slope_a_2.next = slope_a
        slope_u_2.next = slope_u
        slope_v_2.next = slope_v

    # The six products.
    @always_comb
    def multiply():
        way_u.next = distance_2 * slope_u_2
        way_v.next = distance_2 * slope_v_2
        way_low_u.next = to_low_u_2 * slope_a_2
        way_high_u.next = to_high_u_2 * slope_a_2
        way_low_v.next = to_low_v_2 * slope_a_2
        way_high_v.next = to_high_v_2 * slope_a_2

    # Present them.
    @always(clk.posedge)
    def present():
        facet.usable.next = usable_2
        facet.axis.next = axis_2
        facet.distance.next = distance_2
        facet.way_v.next = way_v
        facet.colour.next = colour_2
        start.way_u.next = way_u
        start.low_u.next = way_low_u
        start.high_u.next = way_high_u
        start.low_v.next = way_low_v
        start.high_v.next = way_high_v

    # A product grows where its component of the slope is the one that the column changes, D[y].
    @always(clk.posedge)
    def grow():
        growth.way_u.next = distance_2
        growth.low_u.next = 0
        growth.high_u.next = 0
        growth.low_v.next = 0
        growth.high_v.next = 0
        if axis_2 == 1:
            growth.way_u.next = 0
            growth.low_u.next = to_low_u_2
            growth.high_u.next = to_high_u_2
            growth.low_v.next = to_low_v_2
            growth.high_v.next = to_high_v_2

    # Whose they are.
    @always(clk.posedge)
    def address():
        load.next = 0
        if at_hand_2 and not reset:
            load.next[number_2] = True

    return count, fetch, follow, identify, choose_axes, measure, hold_distances, multiply, present, grow, address
