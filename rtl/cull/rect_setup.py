# SPDX-License-Identifier: MIT
"""The start values for the columns of a row, for one rectangle after another."""

from myhdl import always, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.internals import SignalType
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, signed, unsigned
from raycaster.hdl.verbs import assign, minus, register
from raycaster.rtl.common.by_axis import along_a, along_p, along_q, by_axis
from raycaster.rtl.common.widths import AXIS_BITS, DISTANCE_BITS, index_bits, signed_slope_bits, walk_bits
from raycaster.rtl.engine.array_multiplier import array_multiplier

SETUP_LATENCY = 5
"""Cycles from start_line to the first rectangle's products."""


class Facet(Record):
    """A rectangle as seen by the rays of one row from the camera; see `Walk` for the axis q.

    usable: it may be hit; distance: n = k - E[a] from the camera to its plane; way_q: n D[q], the same for all columns.
    """

    def __init__(self, config: Configuration):
        super().__init__(
            {"usable": 1, "axis": AXIS_BITS, "distance": Signed(DISTANCE_BITS), "way_q": Signed(walk_bits(config))}
        )


class Walk(Record):
    """The compared products that change with the column: n D[p], and (bound - E) D[a] for the four bounds.

    p is y, the axis along which the slope changes per column, or x for a plane across y. q is the third axis.
    """

    def __init__(self, bits: int):
        super().__init__(dict.fromkeys(("way_p", "low_p", "high_p", "low_q", "high_q"), Signed(bits)))


@block
def rect_setup(
    clk, reset, start_line, rects, camera, slope, load: SignalType, facet, growth, start, config: Configuration
):  # fmt: skip
    """Fetch one rectangle per cycle after start_line, and compute the products from which a row starts.

    The outputs follow `SETUP_LATENCY` cycles after start_line for the first rectangle, and then in each cycle for the
    next one.

    A rectangle has six products of a distance and a component of the ray through the first column (Kensler and Shirley
    2006); along the row they grow linearly, so later columns need no multiplication (forward differences). Distances to
    bounds are as wide as the fields of growth, their products as wide as the fields of start.

    The products are made of adders, as the engine's units may need all of the chip's multipliers.

    Args:
        reset: flag; synchronous reset, which ends the sweep.
        start_line: strobe; starts a sweep through all rectangles.
        rects: `Rects`; index and fetch are outputs, and rect, a `WideRect`, comes two cycles after fetch.
        camera: `Camera`; only its position is read.
        slope: `Vector` of the ray through the first column; constant from the third cycle after start_line on.
        load: unsigned output, `config.rectangles` bits, one per rectangle; high for the cycle in which the other
            outputs belong to that rectangle.
        facet: output `Facet` of the rectangle; valid with its bit of load.
        growth: output `Walk`; the change of start per column, valid with load.
        start: output `Walk` of the first column; valid with load.
    """
    slope_bits = signed_slope_bits(config)
    bound_bits = len(growth.low_p)
    product_bits = len(start.way_p)
    last = config.rectangles - 1

    reading, asked, at_hand, at_hand_2 = (bit() for _ in range(SETUP_LATENCY - 1))
    number = unsigned(index_bits(config))
    usable_0, usable = bit(), bit()
    eye_a, plane = signed(DISTANCE_BITS), signed(DISTANCE_BITS)
    eye_p, eye_q, low_p, high_p, low_q, high_q = (signed(bound_bits) for _ in range(6))
    camera_a, camera_p, camera_q = (unsigned(COORDINATE_BITS) for _ in range(3))
    slope_a, slope_p, slope_q = (signed(slope_bits) for _ in range(3))
    distance, measure = minus(plane, eye_a, Signed(DISTANCE_BITS))
    to_low_p, measure_low_p = minus(low_p, eye_p, Signed(bound_bits))
    to_high_p, measure_high_p = minus(high_p, eye_p, Signed(bound_bits))
    to_low_q, measure_low_q = minus(low_q, eye_q, Signed(bound_bits))
    to_high_q, measure_high_q = minus(high_q, eye_q, Signed(bound_bits))

    number_0, number_1, number_2 = (unsigned(index_bits(config)) for _ in range(3))
    usable_2 = bit()
    axis_2 = unsigned(AXIS_BITS)
    distance_2 = signed(DISTANCE_BITS)
    to_low_p_2, to_high_p_2, to_low_q_2, to_high_q_2 = (signed(bound_bits) for _ in range(4))
    slope_a_2, slope_p_2, slope_q_2 = (signed(slope_bits) for _ in range(3))
    way_q = signed(len(facet.way_q))
    way_p, way_low_p, way_high_p, way_low_q, way_high_q = (signed(product_bits) for _ in range(5))

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

    fetch = assign((rects.fetch, rects.index), lambda: (reading, number))
    follow = register(
        clk, (asked, at_hand, at_hand_2), lambda: (reading and not reset, asked and not reset, at_hand and not reset)
    )
    carry_number = register(clk, (number_0, number_1, number_2), lambda: (number, number_0, number_1))
    carry_usable = register(clk, (usable_0, usable, usable_2), lambda: (rects.usable[number], usable_0, usable))

    eyes, slopes = (camera.x, camera.y, camera.z), (slope.x, slope.y, slope.z)
    choices = [
        by_axis(rects.rect.axis, *along(*values), chosen, width=len(chosen))
        for along, values, chosen in (
            (along_a, eyes, camera_a), (along_p, eyes, camera_p), (along_q, eyes, camera_q),
            (along_a, slopes, slope_a), (along_p, slopes, slope_p), (along_q, slopes, slope_q),
        )
    ]  # fmt: skip

    extend = assign((plane, eye_a, eye_p, eye_q), lambda: (rects.rect.position, camera_a, camera_p, camera_q))
    extend_low_p = assign(low_p, lambda: rects.rect.v_low if rects.rect.axis == 2 else rects.rect.u_low)
    extend_high_p = assign(high_p, lambda: rects.rect.v_high if rects.rect.axis == 2 else rects.rect.u_high)
    extend_low_q = assign(low_q, lambda: rects.rect.u_low if rects.rect.axis == 2 else rects.rect.v_low)
    extend_high_q = assign(high_q, lambda: rects.rect.u_high if rects.rect.axis == 2 else rects.rect.v_high)

    hold_distances = register(
        clk,
        (axis_2, distance_2, to_low_p_2, to_high_p_2, to_low_q_2, to_high_q_2, slope_a_2, slope_p_2, slope_q_2),
        lambda: (rects.rect.axis, distance, to_low_p, to_high_p, to_low_q, to_high_q, slope_a, slope_p, slope_q),
        at_hand,
    )

    products = [
        array_multiplier(multiplicand=distance_2, multiplier=slope_p_2, product=way_p),
        array_multiplier(multiplicand=distance_2, multiplier=slope_q_2, product=way_q),
        array_multiplier(multiplicand=to_low_p_2, multiplier=slope_a_2, product=way_low_p),
        array_multiplier(multiplicand=to_high_p_2, multiplier=slope_a_2, product=way_high_p),
        array_multiplier(multiplicand=to_low_q_2, multiplier=slope_a_2, product=way_low_q),
        array_multiplier(multiplicand=to_high_q_2, multiplier=slope_a_2, product=way_high_q),
    ]

    @always(clk.posedge)
    def announce():
        load.next = 0
        if at_hand_2 and not reset:
            load.next[number_2] = True

    new_facet = facet.joined(usable=usable_2, axis=axis_2, distance=distance_2, way_q=way_q)
    first = start.joined(way_p=way_p, low_p=way_low_p, high_p=way_high_p, low_q=way_low_q, high_q=way_high_q)

    more_way_p, more_low_p, more_high_p, more_low_q, more_high_q = (signed(bound_bits) for _ in range(5))

    # A product grows if its slope component is D[y], the one that changes with the column.
    choose_more_way_p = assign(more_way_p, lambda: 0 if axis_2 == 1 else distance_2)
    choose_more_low_p = assign(more_low_p, lambda: to_low_p_2 if axis_2 == 1 else 0)
    choose_more_high_p = assign(more_high_p, lambda: to_high_p_2 if axis_2 == 1 else 0)
    choose_more_low_q = assign(more_low_q, lambda: to_low_q_2 if axis_2 == 1 else 0)
    choose_more_high_q = assign(more_high_q, lambda: to_high_q_2 if axis_2 == 1 else 0)

    more = growth.joined(way_p=more_way_p, low_p=more_low_p, high_p=more_high_p, low_q=more_low_q, high_q=more_high_q)

    present = register(clk, (facet.word, start.word, growth.word), lambda: (new_facet, first, more), at_hand_2)

    return instances()
