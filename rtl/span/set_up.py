# SPDX-License-Identifier: MIT
"""The entries of a chain: the rectangles that its rays meet, each with its columns."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit
from raycaster.rtl.span.clipper import clipper
from raycaster.rtl.span.half_lines import half_lines
from raycaster.rtl.span.records import Entry


@block
def set_up(
    clk, reset, start, chain, from_light, rects, answer, divided, columns, ask, query, divide, division, append, entry,
    count, done, config: Configuration,
):  # fmt: skip
    """Find all entries of a chain, in the order of the table: exactly the columns in which a ray meets the rectangle.

    Args:
        clk: the clock.
        reset: flag; synchronous reset to idle.
        start: strobe; takes a chain while idle.
        chain: `Chain`; constant from the cycle before start to done.
        from_light: flag, read with `config.light`; the chain's rays come from the light. Constant like chain.
        rects: `Rects`; index and fetch are outputs.
        answer: `Answer` of `line_eval`.
        divided: strobe; `first_change` is done.
        columns: unsigned, `column_bits` bits; read with divided.
        ask: output strobe; `line_eval` must answer the query.
        query: output `Query`; valid with ask.
        divide: output strobe; `first_change` must take the division.
        division: output `Division`; valid with divide.
        append: output strobe; another entry.
        entry: output `Entry`; valid with append.
        count: unsigned output, `count_bits` bits; the number of entries so far. From done to the next start, of all.
        done: output strobe; all entries have been appended.
        config: the design.
    """
    slot, free, opened, idle, walked = (bit() for _ in range(5))
    met = Entry(config)

    walk = half_lines(
        clk=clk, reset=reset, start=start, chain=chain, from_light=from_light, rects=rects, answer=answer,
        free=free, done=done, ask=ask,
        query=query, slot=slot, opened=opened, entry=met, walked=walked, config=config,
    )  # fmt: skip
    clip = clipper(
        clk=clk, reset=reset, chain=chain, opened=opened, slot=slot, met=met, answer=answer, divided=divided,
        columns=columns, divide=divide, division=division, free=free, append=append, entry=entry, idle=idle,
        config=config,
    )  # fmt: skip

    @always(clk.posedge)
    def tally():
        if start:
            count.next = 0
        elif append:
            count.next = count + 1

    @always(clk.posedge)
    def end():
        done.next = walked and idle and not (done or reset)

    return instances()
