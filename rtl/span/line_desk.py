# SPDX-License-Identifier: MIT
"""The evaluation of lines and their changes of sign, for all blocks of a span unit."""

from myhdl import always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit
from raycaster.rtl.span.first_change import first_change
from raycaster.rtl.span.line_eval import line_eval
from raycaster.rtl.span.records import Division, Query


@block
def line_desk(
    clk, reset, set_up_asks, sweep_asks, corner_asks, surface_asks, slope, step, aim, answer, config: Configuration
):  # fmt: skip
    """Evaluate the lines of whichever block asks, and divide for whichever block needs it: one at a time.

    Args:
        reset: flag; synchronous reset.
        set_up_asks: `Asks` of `set_up`.
        sweep_asks: `Asks` of `sweep`.
        corner_asks: `Asks` of `corner_finder`; divide and division are not read.
        surface_asks: `Asks` of `surfaces`.
        slope: `Vector` of `signed_slope_bits` bits; the slope of column 0, constant while anything is evaluated.
        step: `Vector`, the slope's change from column to column; see `line_eval`.
        aim: `Aim`; see `line_eval`.
        answer: output `Answer`, to all of them.
    """
    ask, divide = bit(), bit()
    query, division = Query(config), Division(config)

    # The strobe that comes last chooses nothing.
    @always_comb
    def choose_query():
        ask.next = set_up_asks.ask or sweep_asks.ask or corner_asks.ask or surface_asks.ask
        query.word.next = sweep_asks.query.word
        if set_up_asks.ask:
            query.word.next = set_up_asks.query.word
        elif corner_asks.ask:
            query.word.next = corner_asks.query.word
        elif surface_asks.ask:
            query.word.next = surface_asks.query.word

    @always_comb
    def choose_division():
        divide.next = set_up_asks.divide or sweep_asks.divide or surface_asks.divide
        division.word.next = set_up_asks.division.word
        if sweep_asks.divide:
            division.word.next = sweep_asks.division.word
        elif surface_asks.divide:
            division.word.next = surface_asks.division.word

    evaluator = line_eval(
        clk=clk, reset=reset, ask=ask, query=query, slope=slope, step=step, aim=aim, answer=answer, config=config
    )
    divider = first_change(
        clk=clk, reset=reset, start=divide, division=division, columns=answer.columns, done=answer.divided,
        config=config,
    )  # fmt: skip

    return instances()
