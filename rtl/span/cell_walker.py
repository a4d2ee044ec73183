# SPDX-License-Identifier: MIT
"""The cells of a pattern along a row."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.by_axis import along_u, along_v, by_axis
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    PLACE_BITS,
    SMALLEST_CELL_BITS,
    column_bits,
    divisor_bits,
    eye_bits,
    line_bits,
    line_factor_bits,
)
from raycaster.rtl.span.records import NUMBER_BITS

WalkState = enum("IDLE", "ASK", "ANSWER", "DIVIDE")


@block
def cell_walker(
    clk, reset, start, find, on_v, grid, known_cell, column, asks, answer, found_cell, next_column, rises, done,
    config: Configuration,
):  # fmt: skip
    """Find the column in which the next cell of a surface's pattern begins, along u or v, and first the present cell.

    A point of the surface is at P = E + N D' / e along the axis. It is at the edge m of the cells or beyond where N D'
    - (m cell - E) e is not negative: a line, as for a rectangle's bound. Along the row the cells follow each other in
    one direction, up if the edge above the present cell is reached in the span, down if the edge below it is left. If
    that has already happened in the present column, the next cell begins there too.

    The present cell is the quotient of P e, which is the line of edge 0, and of e times the cell's size.

    Args:
        reset: flag; synchronous reset to idle.
        start: strobe; begins while idle.
        find: flag; read with start: cell is not known.
        on_v: flag; along v, otherwise along u. Constant from start to done, like grid and column.
        grid: `Grid` of the grid.
        known_cell: unsigned, `PLACE_BITS` bits; the present cell, read with start without find.
        column: unsigned, `column_bits` bits; the present column.
        asks: output `Asks`.
        answer: `Answer`.
        found_cell: unsigned output, `PLACE_BITS` bits; the present cell, valid with done.
        next_column: unsigned output, `column_bits` bits; the column in which the next cell begins, or grid.stop.
            Valid with done.
        rises: output flag; the next cell's number is greater. Valid with done, don't care if next_column is grid.stop.
        done: output strobe.
        config: the design, with patterns.
    """
    width, factor_bits, far_bits = column_bits(config), line_factor_bits(config), eye_bits(config)
    limit_bits, value_bits, growth_bits = COORDINATE_BITS + 1, line_bits(config), divisor_bits(config)

    state = Signal(WalkState.IDLE)
    finding, second, up, down, at_once, decides, crosses, rose = (bit() for _ in range(8))
    present, place = unsigned(PLACE_BITS), unsigned(PLACE_BITS)
    number = unsigned(PLACE_BITS + 1)
    limit = unsigned(limit_bits)
    whole_limit, offset, eye_w, to_plane, factor_1, factor_2 = (signed(factor_bits) for _ in range(6))
    difference = signed(factor_bits + 1)
    axis_u, axis_v, axis_w, axis_1 = (unsigned(AXIS_BITS) for _ in range(4))
    back_w, back_1 = bit(), bit()
    above_left, above_right = signed(value_bits), signed(value_bits)
    above_growth, growth, slope = (signed(growth_bits) for _ in range(3))
    value, eighth = signed(value_bits), signed(value_bits)
    last, quotient = unsigned(width), unsigned(width)
    none, asked_number = tied(0, 1), unsigned(NUMBER_BITS)
    axes = [tied(axis, AXIS_BITS) for axis in range(3)]
    choices = (
        by_axis(grid.axis, *along_u(*axes), axis_u, width=AXIS_BITS),
        by_axis(grid.axis, *along_v(*axes), axis_v, width=AXIS_BITS),
    )

    choose_axis_w = assign(axis_w, lambda: axis_v if on_v else axis_u)
    choose_back_w = assign(back_w, lambda: grid.back_v if on_v else grid.back_u)
    choose_eye_w = assign(eye_w, lambda: grid.eye_v if on_v else grid.eye_u)

    # The edge above the present cell is asked for first, then the one below it.
    choose_edge = assign(number, lambda: present if second else present + 1)

    @always_comb
    def scale():
        limit.next = 0
        for size in range(PLACE_BITS):
            if (grid.cell == size) and not finding:
                limit.next = (number << (size + SMALLEST_CELL_BITS)) % (1 << limit_bits)

    extend = assign((whole_limit, to_plane), lambda: (limit, grid.distance))

    # An extra bit, as the present cell and the grid may belong to two surfaces while nothing is asked.
    measure = assign(difference, lambda: whole_limit - eye_w)

    keep_offset = assign(offset, lambda: difference[factor_bits:].signed())

    # While the cell is being found, the second line is e itself.
    choose_axis_1 = assign(axis_1, lambda: grid.axis if finding and second else axis_w)
    choose_back_1 = assign(back_1, lambda: grid.back if finding and second else back_w)
    choose_factor_1 = assign(factor_1, lambda: 1 if finding and second else to_plane)
    choose_factor_2 = assign(factor_2, lambda: 0 if finding and second else offset)

    @always_comb
    def see_last():
        last.next = (grid.stop - 1) % (1 << width)
        asked_number.next = second

    asked = asks.query.joined(
        from_light=none, left=column, right=last, strict=none, axis_1=axis_1, back_1=back_1, factor_1=factor_1,
        axis_2=grid.axis, back_2=grid.back, factor_2=factor_2, half_line=none, last=none,
        number=asked_number,
    )  # fmt: skip

    # It is far from a surface to the evaluator.
    @always(clk.posedge)
    def request():
        asks.ask.next = (state == WalkState.ASK) and not reset
        asks.query.word.next = asked

    @always(clk.posedge)
    def keep_first():
        if (state != WalkState.IDLE) and answer.valid and (answer.number == 0):
            above_left.next, above_right.next, above_growth.next = answer.left, answer.right, answer.growth

    see_decides = assign(decides, lambda: (state == WalkState.ANSWER) and answer.valid and (answer.number == 1))
    see_up = assign(up, lambda: above_right >= 0)
    see_down = assign(down, lambda: (above_right < 0) and (answer.right < 0))
    see_at_once = assign(at_once, lambda: above_left >= 0 if above_right >= 0 else answer.left < 0)

    @always_comb
    def see_slope():
        eighth.next = above_left >> SMALLEST_CELL_BITS
        slope.next = answer.left[growth_bits:].signed()

    @always_comb
    def decide():
        crosses.next = decides and (finding or ((up or down) and not at_once))
        value.next, growth.next = answer.left, answer.growth
        if finding:
            value.next, growth.next = eighth, slope
        elif up:
            value.next, growth.next = above_left, above_growth

    crossed = asks.division.joined(value=value, growth=growth)

    start_division = assign((asks.divide, asks.division.word), lambda: (crosses, crossed))

    see_quotient = assign(quotient, lambda: (answer.columns - 1) % (1 << width))

    @always_comb
    def see_place():
        place.next = 0
        for size in range(PLACE_BITS):
            if grid.cell == size:
                place.next = quotient[PLACE_BITS:] >> size

    @always_comb
    def see_done():
        done.next = (decides and not crosses) or ((state == WalkState.DIVIDE) and answer.divided and not finding)
        found_cell.next, rises.next, next_column.next = present, up, grid.stop
        if state == WalkState.DIVIDE:
            rises.next = rose
            next_column.next = (column + answer.columns) % (1 << width)
        elif up or down:
            next_column.next = column

    @always(clk.posedge)
    def step():
        if reset:
            state.next = WalkState.IDLE
        elif start:
            state.next = WalkState.ASK
        elif state == WalkState.ASK:
            if second:
                state.next = WalkState.ANSWER
        elif decides:
            state.next = WalkState.IDLE
            if crosses:
                state.next = WalkState.DIVIDE
        elif (state == WalkState.DIVIDE) and answer.divided:
            state.next = WalkState.IDLE
            if finding:
                state.next = WalkState.ASK

    @always(clk.posedge)
    def follow():
        if start:
            finding.next, present.next = find, known_cell
            second.next = False
        elif state == WalkState.ASK:
            second.next = True
        elif (state == WalkState.DIVIDE) and answer.divided:
            second.next = finding.next = False
            if finding:
                present.next = place
        if decides:
            rose.next = up

    return instances()
