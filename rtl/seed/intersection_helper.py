# SPDX-License-Identifier: MIT
"""One a + b * (c - d) / e unit: where a ray meets a plane, on one axis."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.common.widths import SLOPE_BITS, bit, position_bits, product_bits, signed, unsigned
from raycaster.rtl.seed.divider import divider


@block
def intersection_helper(
    clk,
    steps,
    a,
    b,
    b_negative,
    c,
    d,
    e,
    e_negative,
    value,
    quotient,
    distance,
    valid,
    ahead,
    config: Configuration,
):
    """value = a + b * (c - d) / e where (c - d) / e is positive, by one multiplication and one division of magnitudes.

    a, c, d: unsigned, position_bits; b, e: magnitudes of 9 bits, each with its sign; value: signed, position_bits + 2;
    quotient: |b * (c - d) / e|; distance: |c - d|; both unsigned, position_bits.
    valid: ahead, and the quotient did not overflow; ahead, from the cycle after find_intersection: e is not 0 and the
    plane lies ahead (c - d is not 0 and has e's sign).
    Operands but `a` are taken at steps.find_intersection, load_divider follows two cycles later and store_quotient
    `config.divider_steps` after that; quotient, distance and valid stand from the next cycle, `a` is taken in it,
    and value stands from the cycle after. The next find_intersection may follow config.divider_steps after the first.
    """
    position_width = position_bits(config)
    product_width = product_bits(config)

    difference, opposite = (signed(position_width + 1) for _ in range(2))
    magnitude = unsigned(position_width)
    runs_ahead = bit()
    started_distance, loaded_distance = (unsigned(position_width) for _ in range(2))
    started_b, started_e = (unsigned(SLOPE_BITS) for _ in range(2))
    started_negative, loaded_negative, stored_negative = (bit() for _ in range(3))
    loaded_ahead, stored_ahead = bit(), bit()
    product = unsigned(product_width)
    overflow = bit()
    forward = signed(position_width + 2)
    backward = signed(position_width + 2)

    division = divider(clk, steps.load_divider, steps.store_quotient, product, started_e, quotient, overflow, config)

    # c - d, how far away the plane is along its axis.
    @always_comb
    def subtract():
        difference.next = c - d

    # d - c, in case that is the positive one.
    @always_comb
    def negate():
        opposite.next = -difference

    # Its magnitude, and whether the ray runs towards the plane.
    @always_comb
    def look_ahead():
        if difference < 0:
            magnitude.next = opposite[position_width:]
        else:
            magnitude.next = difference[position_width:]
        runs_ahead.next = (e != 0) and (difference != 0) and ((difference < 0) == e_negative)

    # Take the operands.
    @always(clk.posedge)
    def start():
        if steps.find_intersection:
            started_distance.next = magnitude
            started_b.next = b
            started_e.next = e
            started_negative.next = b_negative
            ahead.next = runs_ahead

    # b * (c - d) as magnitudes: the one multiplier.
    @always(clk.posedge)
    def multiply():
        product.next = started_b * started_distance

    # What belongs to the division at work.
    @always(clk.posedge)
    def load():
        if steps.load_divider:
            loaded_distance.next = started_distance
            loaded_negative.next = started_negative
            loaded_ahead.next = ahead

    # What belongs to the finished quotient.
    @always(clk.posedge)
    def store():
        if steps.store_quotient:
            distance.next = loaded_distance
            stored_negative.next = loaded_negative
            stored_ahead.next = loaded_ahead

    # A quotient that overflowed lies outside the world.
    @always_comb
    def judge():
        valid.next = stored_ahead and not overflow

    # Both results, of which the sign of b chooses.
    @always_comb
    def step_forward():
        forward.next = a + quotient

    # Both results, of which the sign of b chooses.
    @always_comb
    def step_backward():
        backward.next = a - quotient

    # a + b * (c - d) / e.
    @always(clk.posedge)
    def add():
        if stored_negative:
            value.next = backward
        else:
            value.next = forward

    return division, subtract, negate, look_ahead, start, multiply, load, store, judge, step_forward, step_backward, add
