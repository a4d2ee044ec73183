# SPDX-License-Identifier: MIT
"""The columns in which a rectangle is met."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import column_bits
from raycaster.rtl.span.first_change import division_cycles
from raycaster.rtl.span.line_eval import LATENCY
from raycaster.rtl.span.records import BEYOND, U_LOW, Entry

FEWEST_LINES = BEYOND - U_LOW
"""Half-lines of a rectangle that a chain's rays may meet: its bounds."""


def places(config: Configuration) -> int:
    """Places for rectangles that are on their way from their opening to their end; one stays free."""
    most = 2 + (LATENCY + division_cycles(config) + 2) // FEWEST_LINES
    return 1 << bits_for(most + 1)


@block
def clipper(clk, reset, chain, opened, met, asks, answer, append, entry, idle, config: Configuration):
    """Find the columns of a chain in which all half-lines of a rectangle are not negative; append an entry if any.

    Each line passes the divider, so that nothing ever waits: a line that is negative at both ends of the chain rejects
    the rectangle, and one whose sign changes narrows its columns.

    Args:
        reset: flag; synchronous reset, which forgets all rectangles.
        chain: `Chain`; start and stop are read, constant while not idle, and in the cycle before.
        opened: strobe; the answers of a rectangle follow, the last one marked by answer.last, after those of the one
            before. It has at least `FEWEST_LINES`, and they are asked for one per cycle from the next cycle on.
        met: `Entry`, whose start and stop are ignored; read with opened.
        asks: output `Asks`; only divide and division are driven.
        answer: `Answer`.
        append: output strobe; the rectangle is met in some columns.
        entry: output `Entry`; valid with append.
        idle: output flag; all rectangles have been appended or rejected.
    """
    width, cycles, count = column_bits(config), division_cycles(config), places(config)
    flags = 4

    on_way = unsigned(flags * cycles)
    judged = unsigned(flags)
    negative, change, first_negative = (bit() for _ in range(3))
    last, refuses, narrows, rises = (bit() for _ in range(4))
    ended, refused, renewed = bit(), bit(), bit()
    start, stop, low, high, border = (unsigned(width) for _ in range(5))
    put, taken = unsigned(bits_for(count)), unsigned(bits_for(count))
    entries = [unsigned(len(met.word)) for _ in range(count)]
    oldest = Entry(config)

    @always_comb
    def judge():
        first_negative.next = answer.left < 0
        negative.next = (answer.left < 0) and (answer.right < 0)
        change.next = (answer.left < 0) != (answer.right < 0)

    @always_comb
    def see_line():
        judged.next = 0
        if answer.valid and answer.half_line:
            judged.next = concat(answer.last, negative, change, first_negative)

    # All other lines are divided for nothing.
    divided = asks.division.joined(value=answer.left, growth=answer.growth)

    @always_comb
    def start_division():
        asks.divide.next = answer.valid and answer.half_line
        asks.division.word.next = divided

    @always(clk.posedge)
    def follow():
        on_way.next = 0
        if not reset:
            on_way.next = concat(on_way[flags * (cycles - 1) :], judged)

    @always_comb
    def see_flags():
        last.next = on_way[flags * cycles - 1]
        refuses.next = on_way[flags * cycles - 2]
        narrows.next = on_way[flags * cycles - 3]
        rises.next = on_way[flags * cycles - 4]

    begin_renewed = assign(renewed, lambda: idle or ended)
    begin_low = assign(low, lambda: chain.start if idle or ended else start)
    begin_high = assign(high, lambda: chain.stop if idle or ended else stop)
    find_border = assign(border, lambda: (chain.start + answer.columns) % (1 << width))

    @always(clk.posedge)
    def clip():
        ended.next = last and not reset
        refused.next = refuses or (refused and not renewed)
        start.next, stop.next = low, high
        if narrows:
            if rises and (border > low):
                start.next = border
            elif (not rises) and (border < high):
                stop.next = border

    keep = register(clk, entries[put], lambda: met.word, opened)

    @always(clk.posedge)
    def count_entries():
        if reset:
            put.next = taken.next = 0
        else:
            if opened:
                put.next = (put + 1) % count
            if ended:
                taken.next = (taken + 1) % count

    see_idle = assign(idle, lambda: put == taken)

    # Nothing ends in the cycles after an opening and after an end, as a rectangle has several lines.
    look_up = register(clk, oldest.word, lambda: entries[taken])

    found = entry.joined(
        index=oldest.index, axis=oldest.axis, back=oldest.back, distance=oldest.distance, start=start, stop=stop
    )

    @always_comb
    def present():
        append.next = ended and (not refused) and (start < stop)
        entry.word.next = found

    return instances()
