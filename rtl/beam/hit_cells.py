# SPDX-License-Identifier: MIT
"""In which cells of its pattern a rectangle is hit."""

from itertools import pairwise

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.engines.beam import CELL_LATENCY
from raycaster.engines.engine import SMALLEST_CELL_BITS
from raycaster.rtl.beam.cell_step import cell_step
from raycaster.rtl.common.delay_line import delay_line
from raycaster.rtl.common.records import CellDivision, winner_of
from raycaster.rtl.common.widths import (
    AXIS_BITS,
    CELL_BITS,
    bit,
    exact_slope_bits,
    eye_bits,
    signed,
    turn_bits,
    unsigned,
)


@block
def hit_cells(clk, turn, nearest, winner, slope, camera, sight, config: Configuration):
    """Find in which cells of its pattern a rectangle is hit: a hit per clock, the cells `CELL_LATENCY` cycles later.

    With the mirrored eye E' and slope D', the ray is at E' + D' t, and t is the hit's numerator / denominator. So the
    quotient of E' * denominator + D' * numerator and the denominator is a world coordinate (Heckbert and Hanrahan
    1984). A restoring division finds its bit that is worth a cell. Only the nearest rectangle's cells are found.

    Args:
        clk: the clock.
        turn: `Turn` of the ray; read a cycle after nearest.
        nearest: `Candidate`; the nearest hit.
        winner: `Winner`; the rectangle of nearest, in the same cycle.
        slope: `Direction`; D, read `CELL_SLOPE_AT` cycles after nearest.
        camera: `Camera`; the live one.
        sight: `Sight`; output, winner with odd_u and odd_v, `CELL_LATENCY` cycles after it.
        config: the design.
    """
    slope_bits, numerator_bits, base_bits = exact_slope_bits(config), eye_bits(config) - 1, turn_bits(config) + 1
    way_bits, base_way_bits = slope_bits + 1 + numerator_bits, base_bits + slope_bits
    sum_bits = max(way_bits, base_way_bits) + 1
    dividend_bits = slope_bits + COORDINATE_BITS
    places = range(COORDINATE_BITS - 1, SMALLEST_CELL_BITS - 1, -1)

    axis_1, axis_2 = unsigned(AXIS_BITS), unsigned(AXIS_BITS)
    cell_1, cell_2, cell_3, cell_4 = (unsigned(CELL_BITS) for _ in range(4))
    numerator_1, denominator_1 = unsigned(numerator_bits), unsigned(slope_bits)
    numerator_2, numerator_3 = signed(numerator_bits + 1), signed(numerator_bits + 1)
    denominator_2, denominator_3 = signed(slope_bits + 1), signed(slope_bits + 1)
    base_u, base_v, base_u_3, base_v_3 = (signed(base_bits) for _ in range(4))
    back_u_2, back_v_2, back_u_3, back_v_3, back_u_4, back_v_4 = (bit() for _ in range(6))
    slope_u, slope_v = signed(slope_bits + 1), signed(slope_bits + 1)
    base_way_u, base_way_v = signed(base_way_bits), signed(base_way_bits)
    way_u, way_v = signed(way_bits), signed(way_bits)
    denominator_4 = unsigned(slope_bits)
    sum_u, sum_v = signed(sum_bits), signed(sum_bits)
    late = winner_of(config)

    of_u, of_v = ([CellDivision(slope_bits, place + 1) for place in (*places, places[-1] - 1)] for _ in "uv")
    dividend_u, dividend_v, quotient_u, quotient_v = of_u[0], of_v[0], of_u[-1], of_v[-1]

    delay = delay_line(clk, winner.word, late.word, CELL_LATENCY)

    @always(clk.posedge)
    def stage_1():
        axis_1.next = nearest.axis
        cell_1.next = nearest.cell
        numerator_1.next = nearest.numerator
        denominator_1.next = nearest.denominator

    # The mirrored eye.
    @always(clk.posedge)
    def stage_2():
        if axis_1 == 0:
            base_u.next = turn.turn_y + camera.y
            back_u_2.next = turn.back_y
        else:
            base_u.next = turn.turn_x + camera.x
            back_u_2.next = turn.back_x
        if axis_1 == 2:
            base_v.next = turn.turn_y + camera.y
            back_v_2.next = turn.back_y
        else:
            base_v.next = turn.turn_z + camera.z
            back_v_2.next = turn.back_z
        axis_2.next = axis_1
        cell_2.next = cell_1
        numerator_2.next = numerator_1
        denominator_2.next = denominator_1

    @always(clk.posedge)
    def stage_3():
        slope_u.next = slope.x
        slope_v.next = slope.z
        if axis_2 == 0:
            slope_u.next = slope.y
        if axis_2 == 2:
            slope_v.next = slope.y
        base_u_3.next = base_u
        base_v_3.next = base_v
        back_u_3.next = back_u_2
        back_v_3.next = back_v_2
        cell_3.next = cell_2
        numerator_3.next = numerator_2
        denominator_3.next = denominator_2

    @always(clk.posedge)
    def stage_4():
        base_way_u.next = base_u_3 * denominator_3
        base_way_v.next = base_v_3 * denominator_3
        way_u.next = slope_u * numerator_3
        way_v.next = slope_v * numerator_3
        back_u_4.next = back_u_3
        back_v_4.next = back_v_3
        cell_4.next = cell_3
        denominator_4.next = denominator_3[slope_bits:]

    @always_comb
    def add():
        sum_u.next = base_way_u + way_u
        sum_v.next = base_way_v + way_v
        if back_u_4:
            sum_u.next = base_way_u - way_u
        if back_v_4:
            sum_v.next = base_way_v - way_v

    # Of a hit it is within the world. Otherwise it is don't care.
    @always(clk.posedge)
    def stage_5():
        dividend_u.word.next = concat(sum_u[dividend_bits:], denominator_4, cell_4, False)
        dividend_v.word.next = concat(sum_v[dividend_bits:], denominator_4, cell_4, False)

    steps_u = [
        cell_step(clk, before=before, after=after, place=place)
        for place, (before, after) in zip(places, pairwise(of_u), strict=True)
    ]
    steps_v = [
        cell_step(clk, before=before, after=after, place=place)
        for place, (before, after) in zip(places, pairwise(of_v), strict=True)
    ]

    @always_comb
    def join():
        sight.word.next = concat(late.valid, quotient_u.odd, quotient_v.odd, late.index)

    return instances()
