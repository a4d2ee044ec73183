# SPDX-License-Identifier: MIT
"""The values of a line at two columns."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import line_bits, line_factor_bits, operand_bits, operand_growth_bits
from raycaster.rtl.span.operand_ends import operand_ends
from raycaster.rtl.span.records import NUMBER_BITS, Query

LATENCY = 5
"""Cycles from a query to its answer."""


@block
def line_eval(clk, reset, ask, query, slope, step, aim, answer, config: Configuration):
    """Evaluate f(c) = factor_1 X(c) - factor_2 Y(c) - strict at two columns, and its growth; a new line per cycle.

    Every decision of a row is the sign of such a line, or the column at which the sign changes. X and Y are components
    of the slope D(c) = slope + c step, negated or not.

    Args:
        reset: flag; synchronous reset, after which no answer is under way.
        ask: strobe; evaluate the query of this cycle.
        query: `Query`; read with ask.
        slope: `Vector` of `signed_slope_bits` bits; the slope of column 0, constant while anything is evaluated.
        step: `Vector` of `step_bits` bits; the slope's change from column to column, constant like slope. Only read
            with `config.turn`; otherwise it is (0, 1, 0).
        aim: `Aim`; read with `config.light`, constant while lines from the light are evaluated.
        answer: output `Answer`, `LATENCY` cycles after its query.
    """
    factor_bits, slope_bits, growth_bits = line_factor_bits(config), operand_bits(config), operand_growth_bits(config)
    kept = line_bits(config)
    product_bits, growth_product_bits = factor_bits + slope_bits, factor_bits + growth_bits

    asked_1, asked_2, asked_3, asked_4 = (bit() for _ in range(LATENCY - 1))
    query_1, query_2, query_3 = (Query(config) for _ in range(3))
    opposite_1, opposite_2 = signed(factor_bits + 1), signed(factor_bits + 1)
    factor_1_2, factor_2_2, factor_1_3, factor_2_3 = (signed(factor_bits) for _ in range(4))
    strict_4, half_line_4, last_4 = (bit() for _ in range(3))
    number_4 = unsigned(NUMBER_BITS)
    x_left, x_right, y_left, y_right = (signed(slope_bits) for _ in range(4))
    x_growth, y_growth = signed(growth_bits), signed(growth_bits)
    ax_left, ax_right, by_left, by_right = (signed(product_bits) for _ in range(4))
    ax_growth, by_growth, ax_grown, by_grown = (signed(growth_product_bits) for _ in range(4))
    left, right = signed(product_bits + 2), signed(product_bits + 2)
    grown_bits = len(answer.growth)
    grown = signed(max(grown_bits, growth_product_bits + 1))

    # A number at the end of a name is the stage whose registers hold it.
    operands = (
        operand_ends(
            clk=clk, axis=query_1.axis_1, from_light=query_1.from_light, left=query_1.left, right=query_1.right,
            slope=slope, step=step, aim=aim, at_left=x_left, at_right=x_right, growth=x_growth, config=config,
        ),
        operand_ends(
            clk=clk, axis=query_1.axis_2, from_light=query_1.from_light, left=query_1.left, right=query_1.right,
            slope=slope, step=step, aim=aim, at_left=y_left, at_right=y_right, growth=y_growth, config=config,
        ),
    )  # fmt: skip

    @always(clk.posedge)
    def follow():
        if reset:
            asked_1.next = asked_2.next = asked_3.next = asked_4.next = answer.valid.next = False
        else:
            asked_1.next, asked_2.next, asked_3.next, asked_4.next = ask, asked_1, asked_2, asked_3
            answer.valid.next = asked_4

    carry = register(clk, (query_1.word, query_2.word, query_3.word), lambda: (query.word, query_1.word, query_2.word))

    # A factor is negated, as it has fewer bits than the values.
    @always_comb
    def negate():
        opposite_1.next = -query_1.factor_1
        opposite_2.next = -query_1.factor_2

    @always(clk.posedge)
    def turn():
        factor_1_2.next, factor_2_2.next = query_1.factor_1, query_1.factor_2
        if query_1.back_1:
            factor_1_2.next = opposite_1[factor_bits:].signed()
        if query_1.back_2:
            factor_2_2.next = opposite_2[factor_bits:].signed()
        factor_1_3.next, factor_2_3.next = factor_1_2, factor_2_2

    if config.turn or config.light:

        @always_comb
        def multiply_growth():
            ax_growth.next = factor_1_3 * x_growth
            by_growth.next = factor_2_3 * y_growth

    else:
        multiply_ax_growth = assign(ax_growth, lambda: factor_1_3 if x_growth != 0 else 0)
        multiply_by_growth = assign(by_growth, lambda: factor_2_3 if y_growth != 0 else 0)

    @always(clk.posedge)
    def stage_4():
        ax_left.next = factor_1_3 * x_left
        ax_right.next = factor_1_3 * x_right
        by_left.next = factor_2_3 * y_left
        by_right.next = factor_2_3 * y_right
        ax_grown.next, by_grown.next = ax_growth, by_growth
        strict_4.next, half_line_4.next = query_3.strict, query_3.half_line
        last_4.next, number_4.next = query_3.last, query_3.number

    @always_comb
    def subtract():
        left.next = ax_left - by_left - strict_4
        right.next = ax_right - by_right - strict_4
        grown.next = ax_grown - by_grown

    @always(clk.posedge)
    def stage_5():
        answer.left.next = left[kept:].signed()
        answer.right.next = right[kept:].signed()
        answer.growth.next = grown[grown_bits:].signed()
        answer.half_line.next, answer.last.next, answer.number.next = half_line_4, last_4, number_4

    return instances()
