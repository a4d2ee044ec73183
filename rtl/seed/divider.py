# SPDX-License-Identifier: MIT
"""The iterative divider: one, two or three quotient bits per cycle."""

from myhdl import always, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits, product_bits
from raycaster.rtl.engine.divider_step import divider_step


@block
def divider(clk, load_divider, store_quotient, dividend, divisor, quotient, overflow, config: Configuration):
    """Divide two unsigned numbers, `config.divider_bits` quotient bits per cycle.

    The quotient is truncated, or rounded to nearest with halves upward. A division takes `config.divider_steps` cycles
    from load_divider to store_quotient; the next load_divider may coincide with that store_quotient.

    Args:
        load_divider: strobe; takes the operands.
        store_quotient: strobe, `config.divider_steps` cycles after load_divider; takes the result.
        dividend: unsigned, `product_bits` bits; read with load_divider.
        divisor: unsigned, 9 bits; read with load_divider.
        quotient: unsigned output, `position_bits` bits; valid from the cycle after store_quotient to the next
            store_quotient.
        overflow: output flag; the quotient needs more than `position_bits` bits, or the divisor is 0; the quotient is
            then don't care. Valid at the same times as quotient.
    """
    width = config.divider_bits * config.divider_steps
    bits_a_cycle = config.divider_bits
    quotient_width = position_bits(config)
    dividend_width = product_bits(config)
    round_to_nearest = config.rounding == "nearest"

    remainders = [unsigned(SLOPE_BITS) for _ in range(bits_a_cycle + 1)]
    digits = [unsigned(width) for _ in range(bits_a_cycle + 1)]
    remainder, last_remainder = remainders[0], remainders[-1]
    pending, last_pending = digits[0], digits[-1]
    divisor_held = unsigned(SLOPE_BITS)
    too_large = bit()
    steps = [
        divider_step(
            remainder=remainders[i], digits=digits[i], divisor=divisor_held, next_remainder=remainders[i + 1],
            next_digits=digits[i + 1],
        )
        for i in range(bits_a_cycle)
    ]  # fmt: skip

    @always(clk.posedge)
    def divide():
        if load_divider:
            remainder.next = dividend[dividend_width:width]
            pending.next = dividend[width:]
            divisor_held.next = divisor
            too_large.next = dividend[dividend_width:quotient_width] >= divisor
        else:
            remainder.next, pending.next = last_remainder, last_pending

    if not round_to_nearest:
        store = register(clk, (quotient, overflow), lambda: (last_pending[quotient_width:], too_large), store_quotient)

        return instances()

    twice_remainder = unsigned(SLOPE_BITS + 1)
    truncated = unsigned(quotient_width)
    truncated_overflow, round_up = bit(), bit()
    rounded = unsigned(quotient_width + 1)

    double_remainder = assign(twice_remainder, lambda: concat(last_remainder, False))

    # A remainder of half the divisor or more rounds up.
    @always(clk.posedge)
    def store_truncated():
        if store_quotient:
            truncated.next = last_pending[quotient_width:]
            truncated_overflow.next = too_large
            round_up.next = twice_remainder >= divisor_held

    # Rounding follows the register, and may carry into one more bit.
    round_quotient = assign(rounded, lambda: truncated + round_up)
    deliver = assign(
        (quotient, overflow), lambda: (rounded[quotient_width:], truncated_overflow or rounded[quotient_width])
    )

    return instances()
