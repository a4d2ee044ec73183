# SPDX-License-Identifier: MIT
"""The column at which a line's sign changes."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bits_for, signed, unconnected, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.widths import divisor_bits, line_bits
from raycaster.rtl.span.division_stage import division_stage


def stage_bits(config: Configuration) -> int:
    """Quotient bits of a stage: a design with a light is too large for the clock if its stages have two."""
    return 1 if config.light else 2


def quotient_bits(config: Configuration) -> int:
    """Width of a quotient: a change lies within the screen's columns."""
    return bits_for(config.screen_geometry.columns)


def division_cycles(config: Configuration) -> int:
    """Return the cycles of a division, from a line to the column of its change."""
    return -(-quotient_bits(config) // stage_bits(config)) + 2


@block
def first_change(clk, reset, start, division, columns, done, config: Configuration):
    """Count the columns up to the first one at which a line's sign differs; a new line per cycle.

    With f the value and g the growth it is 1 + floor(y / |g|), y = f if f >= 0 and -f - 1 otherwise: one formula for
    lines that rise and lines that fall. If the quotient is not less than the number of columns, columns is don't care.

    Args:
        reset: flag; synchronous reset, which ends all divisions.
        start: strobe; takes the line.
        division: `Division`; read with start.
        columns: unsigned output, `column_bits` bits; valid with done.
        done: output strobe, `division_cycles` after start.
    """
    bits, cycles, width = quotient_bits(config), division_cycles(config), divisor_bits(config) - 1
    value_bits, stages, steps = line_bits(config), division_cycles(config) - 2, stage_bits(config)
    top = bits + width

    # The highest bits are 0 if the quotient is as small as it must be.
    y = unsigned(max(value_bits, top + 1))
    kept_value, kept_growth = signed(value_bits), signed(width + 1)
    under_way = unsigned(cycles)
    # Before each stage, and after the last one.
    remainders, divisors = ([*(unsigned(width) for _ in range(stages)), unconnected(width)] for _ in range(2))
    digits = [unsigned(bits) for _ in range(stages + 1)]
    first_remainder, first_digits, size, quotient = remainders[0], digits[0], divisors[0], digits[stages]

    keep = register(clk, (kept_value, kept_growth), lambda: (division.value, division.growth))
    absolute = magnitude(kept_growth, size)

    @always_comb
    def complement():
        y.next = kept_value[value_bits - 1 :]
        if kept_value < 0:
            y.next = ~kept_value[value_bits - 1 :]

    @always_comb
    def split():
        first_remainder.next = y[top:bits]
        first_digits.next = y[bits:]

    # The last stage has what is left of the bits.
    divide = [
        division_stage(
            clk=clk, remainder=remainders[i], digits=digits[i], divisor=divisors[i], next_remainder=remainders[i + 1],
            next_digits=digits[i + 1], next_divisor=divisors[i + 1],
            steps=min(steps, bits - i * steps),
        )
        for i in range(stages)
    ]  # fmt: skip

    @always(clk.posedge)
    def follow():
        under_way.next = 0
        if not reset:
            under_way.next = concat(under_way[cycles - 1 :], start)

    see_end = assign(done, lambda: under_way[cycles - 1])
    show = register(clk, columns, lambda: (quotient + 1) % (1 << len(columns)))

    return instances()
