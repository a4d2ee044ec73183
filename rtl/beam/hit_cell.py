# SPDX-License-Identifier: MIT
"""The cell of its pattern in which a rectangle is hit, along one axis."""

from itertools import pairwise

from myhdl import always, always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.rtl.beam.cell_step import cell_step
from raycaster.rtl.common.records import CellDivision
from raycaster.rtl.common.widths import CELL_BITS, SMALLEST_CELL_BITS


@block
def hit_cell(clk, shift, eye, back, slope, numerator, denominator, cell_size, odd):
    """Find the cell of its pattern in which a rectangle is hit, along one axis; one hit per clock.

    (E' * denominator + D' * numerator) / denominator is a world coordinate, with the mirrored eye E' = E + T and slope
    D' = +-D. A restoring division finds the quotient's bit whose weight is the cell size.

    Args:
        clk: the clock.
        shift: signed; T.
        eye: unsigned; E, read with shift.
        back: flag; D' is -D. Read with shift.
        slope: signed; D, read a cycle after shift.
        numerator: unsigned; t = numerator / denominator of the hit, read with shift.
        denominator: unsigned, one bit narrower than slope; read with shift.
        cell_size: unsigned, 3 bits; log2 of the cell's size in world units, minus three. Read with shift.
        odd: output flag; the lowest bit of floor(coordinate / cell), `CELL_LATENCY` - 1 cycles after shift. A cell as
            large as the world, or larger, is even.
    """
    slope_bits, numerator_bits, base_bits = len(denominator), len(numerator), len(shift) + 1
    way_bits, base_way_bits = slope_bits + 1 + numerator_bits, base_bits + slope_bits
    dividend_bits = slope_bits + COORDINATE_BITS
    powers = range(COORDINATE_BITS - 1, SMALLEST_CELL_BITS - 1, -1)

    base_2, base_3 = signed(base_bits), signed(base_bits)
    numerator_2, numerator_3 = signed(numerator_bits + 1), signed(numerator_bits + 1)
    denominator_2, denominator_3 = signed(slope_bits + 1), signed(slope_bits + 1)
    denominator_4 = unsigned(slope_bits)
    cell_2, cell_3, cell_4 = (unsigned(CELL_BITS) for _ in range(3))
    back_2, back_3, back_4 = bit(), bit(), bit()
    slope_3 = signed(slope_bits + 1)
    base_way, way = signed(base_way_bits), signed(way_bits)
    total = signed(max(way_bits, base_way_bits) + 1)
    stages = [CellDivision(slope_bits, power + 1) for power in (*powers, powers[-1] - 1)]
    dividend, quotient = stages[0], stages[-1]

    @always(clk.posedge)
    def stage_2():
        base_2.next = shift + eye
        back_2.next = back
        cell_2.next = cell_size
        numerator_2.next = numerator
        denominator_2.next = denominator

    @always(clk.posedge)
    def stage_3():
        slope_3.next = slope
        base_3.next = base_2
        back_3.next = back_2
        cell_3.next = cell_2
        numerator_3.next = numerator_2
        denominator_3.next = denominator_2

    @always(clk.posedge)
    def stage_4():
        base_way.next = base_3 * denominator_3
        way.next = slope_3 * numerator_3
        back_4.next = back_3
        cell_4.next = cell_3
        denominator_4.next = denominator_3[slope_bits:]

    @always_comb
    def add():
        total.next = base_way + way
        if back_4:
            total.next = base_way - way

    # For a hit the quotient is within the world; otherwise it is don't care.
    start = dividend.joined(rest=total(dividend_bits, 0), divisor=denominator_4, cell=cell_4, odd=False)

    @always(clk.posedge)
    def stage_5():
        dividend.word.next = start

    steps = [
        cell_step(clk, before=before, after=after, power=power)
        for power, (before, after) in zip(powers, pairwise(stages), strict=True)
    ]

    @always_comb
    def leave():
        odd.next = quotient.odd

    return instances()
