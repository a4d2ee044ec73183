# SPDX-License-Identifier: MIT
"""The pattern cells of a hit point, from the few quotient bits that decide them."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import COORDINATE_BITS
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import PLACE_BITS, SMALLEST_CELL_BITS
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.rtl.exact.hit_component import hit_component

DIVISION_CYCLES = PLACE_BITS // 2
"""Cycles of a division, with two quotient bits per cycle."""


@block
def cell_finder(clk, steps, eye, signs, slope, found_surface, found_distance, found_slope, odd_u, odd_v):
    """Find the lowest bits of floor(P[u] / cell) and floor(P[v] / cell), P the hit point, by a short division.

    P = (E e + D n) / e is within the world, and is the real hit point even for a mirrored eye. So only the highest few
    bits of the quotient decide, and a restoring division finds two of them per cycle. The dividend's bits above them
    are less than e.

    The division for P[u] begins at steps.load_divider. `DIVISION_CYCLES` cycles later, at steps.store_quotient, its bit
    is stored and the division for P[v] begins, which takes as long. All other inputs must be stable until it ends.
    Without a hit the outputs are don't care. A cell as large as the world, or larger, is even.

    Args:
        steps: `Steps`; only load_divider and store_quotient are read.
        eye: `Vector`, E.
        signs: `Signs` of the slope D.
        slope: `Slope`, the magnitudes of D.
        found_surface: `Surface`, with patterns, of the rectangle that was hit.
        found_distance: unsigned; n, the distance from the eye to the plane of found_surface.
        found_slope: unsigned; e, the magnitude of the slope on that plane's axis.
        odd_u: output flag; the lowest bit of floor(P[u] / cell). Valid from the cycle after steps.store_quotient.
        odd_v: output flag; the lowest bit of floor(P[v] / cell). Valid `DIVISION_CYCLES` cycles after
            steps.store_quotient.
    """
    slope_bits, eye_bits = len(found_slope), len(eye.x)
    point_bits = slope_bits + COORDINATE_BITS

    on_x, on_z = bit(), bit()
    eye_q = signed(eye_bits)
    slope_q = unsigned(slope_bits)
    back_q = bit()
    point = unsigned(point_bits)

    remainder, remainder_1, remainder_2 = (unsigned(slope_bits) for _ in range(3))
    digits, digits_1, digits_2 = (unsigned(PLACE_BITS) for _ in range(3))
    first_step = divider_step(remainder, digits, found_slope, remainder_1, digits_1)
    second_step = divider_step(remainder_1, digits_1, found_slope, remainder_2, digits_2)

    # u is x except on a rectangle across x, and v is z except on one across z.
    see_x = assign(on_x, lambda: (not steps.store_quotient) and (found_surface.axis != 0))
    see_z = assign(on_z, lambda: steps.store_quotient and (found_surface.axis != 2))

    @always_comb
    def choose_axis():
        if on_x:
            eye_q.next, slope_q.next, back_q.next = eye.x, slope.dx, signs.dx
        elif on_z:
            eye_q.next, slope_q.next, back_q.next = eye.z, slope.dz, signs.dz
        else:
            eye_q.next, slope_q.next, back_q.next = eye.y, slope.dy, signs.dy

    whole = hit_component(
        eye=eye_q, back=back_q, slope=slope_q, distance=found_distance, e=found_slope, component=point
    )  # fmt: skip

    @always(clk.posedge)
    def divide():
        if steps.load_divider or steps.store_quotient:
            remainder.next = point[point_bits:COORDINATE_BITS]
            digits.next = point[COORDINATE_BITS:SMALLEST_CELL_BITS]
        else:
            remainder.next, digits.next = remainder_2, digits_2

    @always_comb
    def choose_digit():
        odd_v.next = False
        for size in range(PLACE_BITS):
            if found_surface.cell == size:
                odd_v.next = digits_2[size]

    keep_u = register(clk, odd_u, lambda: odd_v, steps.store_quotient)

    return instances()
