# SPDX-License-Identifier: MIT
"""A unit for a + b * (c - d) / e: one coordinate of the point where a ray meets a plane."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.records import Record
from raycaster.hdl.signals import Signed, bit, unsigned
from raycaster.hdl.verbs import assign, minus, plus, register
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits, product_bits
from raycaster.rtl.seed.divider import divider

LOAD_AT = 2
"""Cycles from find_intersection to load_divider; store_quotient follows after the cycles of a division."""

WRITE_AFTER = 2
"""Cycles from store_quotient to the value, and to write_z_buf."""


@block
def intersection_helper(
    clk, steps, a, b, b_negative, c, d, e, e_negative, value, quotient, distance, valid, towards, config: Configuration
):
    """Compute value = a + b * (c - d) / e, for positive (c - d) / e: one coordinate of a ray's point on a plane.

    It takes one multiplication and one division of magnitudes.

    steps.find_intersection takes all operands except a. steps.load_divider follows `LOAD_AT` cycles later, and
    steps.store_quotient `config.divider_steps` cycles after that. quotient, distance and valid are valid from the next
    cycle, in which a is taken; value is valid from the cycle after that. The next steps.find_intersection may follow
    `config.divider_steps` cycles after the first.

    Args:
        steps: `Steps`; find_intersection, load_divider and store_quotient are read.
        a: unsigned, `position_bits` bits; taken in the cycle after steps.store_quotient.
        b: unsigned, 9 bits, magnitude of b; read with steps.find_intersection.
        b_negative: flag, the sign of b; read with steps.find_intersection.
        c: unsigned, `position_bits` bits; read with steps.find_intersection.
        d: unsigned, `position_bits` bits; read with steps.find_intersection.
        e: unsigned, 9 bits, magnitude of e; read with steps.find_intersection.
        e_negative: flag, the sign of e; read with steps.find_intersection.
        value: signed output, `position_bits` + 2 bits; a + b * (c - d) / e. Valid from the second cycle after
            steps.store_quotient.
        quotient: unsigned output, `position_bits` bits; |b * (c - d) / e|. Valid from the cycle after
            steps.store_quotient.
        distance: unsigned output, `position_bits` bits; |c - d|. Valid from the cycle after steps.store_quotient.
        valid: output flag; towards was high for the operands, and the quotient did not overflow. Valid from the cycle
            after steps.store_quotient.
        towards: output flag; e is not 0 and the ray runs towards the plane (c - d is not 0 and has e's sign). Valid
            from the cycle after steps.find_intersection.
    """
    position_width = position_bits(config)
    product_width = product_bits(config)

    difference, subtract = minus(c, d, Signed(position_width + 1))
    away = unsigned(position_width)
    runs_towards, overflow = bit(), bit()
    started_b, started_e = unsigned(SLOPE_BITS), unsigned(SLOPE_BITS)
    product = unsigned(product_width)
    forward, step_forward = plus(a, quotient, Signed(position_width + 2))
    backward, step_backward = minus(a, quotient, Signed(position_width + 2))
    # Flags and distance of the operands, of the division in progress and of the finished quotient: the stages except
    # those of product and value.
    started, loaded, stored = (
        Record({"distance": position_width, "negative": 1, "towards": 1}) for _ in range(LOAD_AT + WRITE_AFTER - 1)
    )

    absolute = magnitude(difference, away)
    division = divider(
        clk=clk, load_divider=steps.load_divider, store_quotient=steps.store_quotient, dividend=product,
        divisor=started_e, quotient=quotient, overflow=overflow, config=config,
    )  # fmt: skip

    look_towards = assign(runs_towards, lambda: (e != 0) and (difference != 0) and ((difference < 0) == e_negative))

    operands = started.joined(distance=away, negative=b_negative, towards=runs_towards)

    @always(clk.posedge)
    def carry():
        if steps.find_intersection:
            started_b.next, started_e.next, started.word.next = b, e, operands
        if steps.load_divider:
            loaded.word.next = started.word
        if steps.store_quotient:
            stored.word.next = loaded.word

    multiply = register(clk, product, lambda: started_b * started.distance)

    # If the quotient overflows, the point is outside the world.
    judge = assign(
        (towards, distance, valid), lambda: (started.towards, stored.distance, stored.towards and not overflow)
    )
    add = register(clk, value, lambda: backward if stored.negative else forward)

    return instances()
