# SPDX-License-Identifier: MIT
"""The corner rule: columns in which a ray meets two mirrors in one point."""

from myhdl import always, always_comb, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.by_axis import by_axis
from raycaster.rtl.common.widths import column_bits, line_factor_bits
from raycaster.rtl.span.records import NUMBER_BITS


@block
def corner_finder(
    clk, reset, start, chain, winner, column, stop, asks, answer, needed, corner, part_stop, done, config: Configuration
):  # fmt: skip
    """Find the first columns of a span in which its rays all meet the winner in the last mirror's point, or all do not.

    They meet it there where N m - M e is 0, with t = N / e at the winner and t = M / m at the last mirror. That line is
    not negative in the span, so it is 0 everywhere, in the first column, in the last, or nowhere. A winner on an axis
    that was met in that point already lies strictly beyond, and before the first mirror there is none.

    Args:
        reset: flag; synchronous reset.
        start: strobe; if needed, the line is asked for in the next cycle.
        chain: `Chain`; constant from start to done, like all other inputs of the span.
        winner: `Entry` that is seen in the span.
        column: unsigned, `column_bits` bits; the span's first column.
        stop: unsigned, `column_bits` bits; the column after the span's last.
        asks: output `Asks`; only ask and query are driven.
        answer: `Answer`.
        needed: output flag; the rays may meet both in one point, so the line decides. Combinational.
        corner: output flag; they do, in the columns from column up to stop. Valid from the cycle after start without
            needed, otherwise from the cycle after done, up to the next start.
        part_stop: unsigned output, `column_bits` bits; valid like corner.
        done: output strobe, only after a start with needed.
        config: the design, with reflections.
    """
    width, factor_bits = column_bits(config), line_factor_bits(config)

    waiting, met, at_left, at_right = (bit() for _ in range(4))
    last, next_column = unsigned(width), unsigned(width)
    to_winner, to_mirror = signed(factor_bits), signed(factor_bits)
    none, no_number = tied(0, 1), tied(0, NUMBER_BITS)

    of_winner = by_axis(winner.axis, chain.met_x, chain.met_y, chain.met_z, met, width=1)

    judge = assign(needed, lambda: chain.mirrored and not met)

    @always_comb
    def measure():
        to_winner.next, to_mirror.next = winner.distance, chain.distance
        last.next = (stop - 1) % (1 << width)
        next_column.next = (column + 1) % (1 << width)

    asked = asks.query.joined(
        from_light=none, left=column, right=last, strict=none, axis_1=chain.axis, back_1=chain.back, factor_1=to_winner,
        axis_2=winner.axis, back_2=winner.back, factor_2=to_mirror, half_line=none, last=none,
        number=no_number,
    )  # fmt: skip

    show_query = assign(asks.query.word, lambda: asked)

    @always(clk.posedge)
    def await_answer():
        asks.ask.next = start and needed and not reset
        if reset:
            waiting.next = False
        elif start:
            waiting.next = needed
        elif done:
            waiting.next = False

    @always_comb
    def see_answer():
        done.next = waiting and answer.valid
        at_left.next = answer.left == 0
        at_right.next = answer.right == 0

    @always(clk.posedge)
    def keep():
        if start:
            corner.next = False
            part_stop.next = stop
        elif done:
            corner.next = at_left
            if at_left and not at_right:
                part_stop.next = next_column
            elif at_right and not at_left:
                part_stop.next = last

    return instances()
