# SPDX-License-Identifier: MIT
"""The column at which a line's sign changes."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.widths import divisor_bits, line_bits
from raycaster.rtl.engine.divider_step import divider_step


def quotient_bits(config: Configuration) -> int:
    """Width of a quotient, and cycles of a division: a change lies within the screen's columns."""
    return bits_for(config.screen_geometry.columns)


@block
def first_change(clk, reset, start, division, columns, done, config: Configuration):
    """Count the columns up to the first one at which a line's sign differs, a quotient bit per cycle.

    With f the value and g the growth it is 1 + floor(y / |g|), y = f if f >= 0 and -f - 1 otherwise: one formula for
    lines that rise and lines that fall. The quotient must be less than the number of columns.

    Args:
        clk: the clock.
        reset: flag; synchronous reset, which ends a division.
        start: strobe; takes the line.
        division: `Division`; read with start.
        columns: unsigned output, `column_bits` bits; valid from done up to the next start.
        done: output strobe, `quotient_bits` + 1 cycles after start.
        config: the design.
    """
    steps, width = quotient_bits(config), divisor_bits(config) - 1
    value_bits = line_bits(config)
    top = steps + width

    size = unsigned(width)
    # The highest bits are 0 if the quotient is as small as it must be.
    y = unsigned(max(value_bits, top + 1))
    remainder, next_remainder, divisor = (unsigned(width) for _ in range(3))
    digits, next_digits = unsigned(steps), unsigned(steps)
    left = unsigned(bits_for(steps + 1))
    ending = bit()

    absolute = magnitude(division.growth, size)
    step = divider_step(
        remainder=remainder, digits=digits, divisor=divisor, next_remainder=next_remainder, next_digits=next_digits
    )

    @always_comb
    def complement():
        y.next = division.value[value_bits - 1 :]
        if division.value < 0:
            y.next = ~division.value[value_bits - 1 :]

    @always(clk.posedge)
    def divide():
        if start:
            remainder.next = y[top:steps]
            digits.next = y[steps:]
            divisor.next = size
        else:
            remainder.next = next_remainder
            digits.next = next_digits

    @always_comb
    def see_end():
        ending.next = left == 1

    @always(clk.posedge)
    def count():
        done.next = ending and not reset
        if reset:
            left.next = 0
        elif start:
            left.next = steps
        elif left != 0:
            left.next = left - 1

    @always(clk.posedge)
    def keep():
        if ending:
            columns.next = next_digits + 1

    return instances()
