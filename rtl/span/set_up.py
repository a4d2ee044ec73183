# SPDX-License-Identifier: MIT
"""The entries of a chain: the rectangles that its rays meet, each with its columns."""

from myhdl import always, block, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign
from raycaster.rtl.span.clipper import clipper
from raycaster.rtl.span.half_lines import half_lines
from raycaster.rtl.span.records import Entry


@block
def set_up(
    clk, reset, start, chain, from_light, rects, asks, answer, append, entry, count, done, config: Configuration
):
    """Find all entries of a chain, in the order of the table: exactly the columns in which a ray meets the rectangle.

    Args:
        reset: flag; synchronous reset to idle.
        start: strobe; takes a chain while idle.
        chain: `Chain`; constant from the cycle after start to done.
        from_light: flag, read with `config.light`; the chain's rays come from the light. Constant like chain.
        rects: `Rects`; index and fetch are outputs.
        asks: output `Asks`.
        answer: `Answer`.
        append: output strobe; another entry.
        entry: output `Entry`; valid with append.
        count: unsigned output, `count_bits` bits; the number of entries so far. From done to the next start, of all.
        done: output strobe; all entries have been appended.
    """
    opened, idle, walked = (bit() for _ in range(3))
    met = Entry(config)

    walk = half_lines(
        clk=clk, reset=reset, start=start, chain=chain, from_light=from_light, rects=rects, asks=asks, answer=answer,
        done=done, opened=opened, entry=met, walked=walked, config=config,
    )  # fmt: skip
    clip = clipper(
        clk=clk, reset=reset, chain=chain, opened=opened, met=met, asks=asks, answer=answer, append=append, entry=entry,
        idle=idle, config=config,
    )  # fmt: skip

    @always(clk.posedge)
    def tally():
        if start:
            count.next = 0
        elif append:
            count.next = count + 1

    end = assign(done, lambda: walked and idle)

    return instances()
