# SPDX-License-Identifier: MIT
"""The cells of its pattern in which a rectangle is hit, along both axes."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS, Configuration
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.rtl.beam.hit_cell import hit_cell
from raycaster.rtl.beam.latencies import CELL_LATENCY
from raycaster.rtl.common.by_axis import along_u, along_v, by_axis
from raycaster.rtl.common.delay_line import delay_line
from raycaster.rtl.common.records import Winner
from raycaster.rtl.common.widths import AXIS_BITS, CELL_BITS, exact_slope_bits, eye_bits, shift_bits


@block
def hit_cells(clk, image, nearest, winner, slope, camera, sight, config: Configuration):
    """Find the cells of its pattern in which a rectangle is hit: one hit per clock, `CELL_LATENCY` cycles later.

    With the mirrored eye E' and slope D' (Heckbert and Hanrahan 1984), the ray is at E' + D' t, and t is the hit's
    numerator / denominator; `hit_cell` divides. Only the nearest rectangle's cells are found.

    Args:
        clk: the clock.
        image: `RoomImage` of the ray; read a cycle after nearest.
        nearest: `Candidate`; the nearest hit.
        winner: `Winner`; the rectangle of nearest, in the same cycle.
        slope: `Vector`; D, read `CELL_SLOPE_AT` cycles after nearest.
        camera: `Camera` of the live scene.
        sight: `Sight`; output, winner with odd_u and odd_v, `CELL_LATENCY` cycles after it.
        config: the design.
    """
    shift_width, slope_bits = shift_bits(config), exact_slope_bits(config)
    axis_1, axis_2, cell_1 = unsigned(AXIS_BITS), unsigned(AXIS_BITS), unsigned(CELL_BITS)
    numerator_1, denominator_1 = unsigned(eye_bits(config) - 1), unsigned(slope_bits)
    shift_u, shift_v = signed(shift_width), signed(shift_width)
    slope_u, slope_v = signed(slope_bits + 1), signed(slope_bits + 1)
    eye_u, eye_v = unsigned(COORDINATE_BITS), unsigned(COORDINATE_BITS)
    back_u, back_v, odd_u, odd_v = bit(), bit(), bit(), bit()
    late = Winner(config)

    @always(clk.posedge)
    def stage_1():
        axis_1.next = nearest.axis
        cell_1.next = nearest.cell
        numerator_1.next = nearest.numerator
        denominator_1.next = nearest.denominator

    @always(clk.posedge)
    def stage_2():
        axis_2.next = axis_1

    of_shift, of_back = (image.shift_x, image.shift_y, image.shift_z), (image.back_x, image.back_y, image.back_z)
    of_eye, of_slope = (camera.x, camera.y, camera.z), (slope.x, slope.y, slope.z)
    choices = [
        by_axis(axis, *along(*values), chosen, width=len(chosen))
        for along, axis, values, chosen in (
            (along_u, axis_1, of_shift, shift_u), (along_u, axis_1, of_back, back_u), (along_u, axis_1, of_eye, eye_u),
            (along_v, axis_1, of_shift, shift_v), (along_v, axis_1, of_back, back_v), (along_v, axis_1, of_eye, eye_v),
            (along_u, axis_2, of_slope, slope_u), (along_v, axis_2, of_slope, slope_v),
        )
    ]  # fmt: skip
    cells = [
        hit_cell(
            clk, shift=shift_there, eye=eye, back=back, slope=slope_there, numerator=numerator_1,
            denominator=denominator_1, cell_size=cell_1, odd=odd,
        )
        for shift_there, eye, back, slope_there, odd in (
            (shift_u, eye_u, back_u, slope_u, odd_u), (shift_v, eye_v, back_v, slope_v, odd_v),
        )
    ]  # fmt: skip
    delay = delay_line(clk, winner.word, late.word, CELL_LATENCY)
    result = sight.joined(valid=late.valid, odd_u=odd_u, odd_v=odd_v, index=late.index)

    @always_comb
    def join():
        sight.word.next = result

    return instances()
