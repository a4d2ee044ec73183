# SPDX-License-Identifier: MIT
"""The iterative divider: one, two or three quotient bits a cycle."""

from myhdl import always, always_comb, block

from raycaster.configuration import Configuration
from raycaster.rtl.divider_step import divider_step
from raycaster.rtl.widths import SLOPE_BITS, bit, position_bits, product_bits, unsigned


@block
def divider(clk, load_divider, store_quotient, dividend, divisor, quotient, overflow, config: Configuration):
    """quotient = dividend / divisor, truncated or rounded to nearest with halves upward, as configured.

    dividend: unsigned, product_bits; divisor: unsigned, 9 bits; quotient: unsigned, position_bits; overflow: the
    quotient needs more bits than that, or the divisor is 0; the quotient then means nothing.
    load_divider takes the operands. store_quotient comes `config.divider_steps` cycles later, and the quotient
    stands from the cycle after it until the next store_quotient. The next load_divider may coincide with it.
    """
    digits = config.divider_bits * config.divider_steps
    bits_a_cycle = config.divider_bits
    quotient_width = position_bits(config)
    dividend_width = product_bits(config)
    round_to_nearest = config.rounding == "nearest"

    remainder = unsigned(SLOPE_BITS)
    pending = unsigned(digits)  # dividend digits leave on the left, quotient bits enter on the right
    divisor_held = unsigned(SLOPE_BITS)
    too_large = bit()
    remainders = [unsigned(SLOPE_BITS) for _ in range(bits_a_cycle + 1)]
    first_remainder, last_remainder = remainders[0], remainders[-1]
    digits_down = [bit() for _ in range(bits_a_cycle)]
    quotient_digits = [bit() for _ in range(bits_a_cycle)]
    pending_next = unsigned(digits)
    steps = [
        divider_step(remainders[i], digits_down[i], divisor_held, remainders[i + 1], quotient_digits[i])
        for i in range(bits_a_cycle)
    ]

    # The first step starts from the remainder that the last cycle left.
    @always_comb
    def enter_steps():
        first_remainder.next = remainder
        for i in range(bits_a_cycle):
            digits_down[i].next = pending[digits - 1 - i]

    # Dividend digits move out, this cycle's quotient bits move in.
    @always_comb
    def shift():
        pending_next.next = 0
        pending_next.next[digits:bits_a_cycle] = pending[digits - bits_a_cycle :]
        for i in range(bits_a_cycle):
            pending_next.next[bits_a_cycle - 1 - i] = quotient_digits[i]

    # Load a dividend, or take the next digits of the one at work.
    @always(clk.posedge)
    def divide():
        if load_divider:
            remainder.next = dividend[dividend_width:digits]
            pending.next = dividend[digits:]
            divisor_held.next = divisor
            too_large.next = dividend[dividend_width:quotient_width] >= divisor
        else:
            remainder.next = last_remainder
            pending.next = pending_next

    if not round_to_nearest:
        # The last step's result is the quotient.
        @always(clk.posedge)
        def store():
            if store_quotient:
                quotient.next = pending_next[quotient_width:]
                overflow.next = too_large

        return steps, enter_steps, shift, divide, store

    twice_remainder = unsigned(SLOPE_BITS + 1)
    truncated = unsigned(quotient_width)
    truncated_overflow = bit()
    round_up = bit()
    rounded = unsigned(quotient_width + 1)

    # What is left decides the rounding: half of the divisor or more rounds up.
    @always_comb
    def double_remainder():
        twice_remainder.next = 0
        twice_remainder.next[SLOPE_BITS + 1 : 1] = last_remainder

    # The last step's result is the truncated quotient.
    @always(clk.posedge)
    def store_truncated():
        if store_quotient:
            truncated.next = pending_next[quotient_width:]
            truncated_overflow.next = too_large
            round_up.next = twice_remainder >= divisor_held

    # Rounding comes after the register, and may carry into one bit more.
    @always_comb
    def round_quotient():
        rounded.next = truncated + round_up

    # A carry out of the quotient is one more way to overflow.
    @always_comb
    def deliver():
        quotient.next = rounded[quotient_width:]
        overflow.next = truncated_overflow or rounded[quotient_width]

    return steps, enter_steps, shift, divide, double_remainder, store_truncated, round_quotient, deliver
