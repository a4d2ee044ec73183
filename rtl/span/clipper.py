# SPDX-License-Identifier: MIT
"""The columns in which the rays of a chain meet a rectangle."""

from myhdl import Signal, always, always_comb, block, concat, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.common.widths import column_bits
from raycaster.rtl.span.records import NUMBER_BITS, Division, Entry

ClipState = enum("LOOK", "DIVIDE")

SLOTS = 2


@block
def clipper(clk, reset, chain, opened, slot, met, asks, answer, free, append, entry, idle, config: Configuration):
    """Find the columns of a chain in which all half-lines of a rectangle are not negative; append an entry if any.

    A line that is negative at both ends of the chain rejects the rectangle. A line whose sign changes costs a division,
    one after the other in the order of their numbers, until no column is left. While one rectangle's lines are divided,
    those of the next one are answered: there are two slots, which take turns.

    Args:
        clk: the clock.
        reset: flag; synchronous reset, which empties both slots.
        chain: `Chain`; start and stop are read, constant while slots are in use, and in the cycle before.
        opened: strobe; the answers of a rectangle follow, the last one marked by answer.last.
        slot: flag; read with opened: the slot for that rectangle. The first one after reset is 0, and they take turns.
        met: `Entry`, whose start and stop are ignored; read with opened.
        asks: output `Asks`; only divide and division are driven.
        answer: `Answer`.
        free: output flag; the slot is free.
        append: output strobe; the rectangle is met in some columns.
        entry: output `Entry`; valid with append.
        idle: output flag; both slots are free.
        config: the design.
    """
    width = column_bits(config)
    numbers = 1 << NUMBER_BITS

    state = Signal(ClipState.LOOK)
    pending, complete, rejected = (unsigned(SLOTS) for _ in range(3))
    crossings = unsigned(SLOTS * numbers)
    remaining = unsigned(numbers)
    turn, known, refused, over, crossing, negative, change = (bit() for _ in range(7))
    place, asked = unsigned(NUMBER_BITS + 1), unsigned(NUMBER_BITS + 1)
    lowest = unsigned(NUMBER_BITS)
    start, stop, border = (unsigned(width) for _ in range(3))
    rises = bit()
    entries = [unsigned(len(met.word)) for _ in range(SLOTS)]
    in_turn = Entry(config)
    kept = [unsigned(len(asks.division.word)) for _ in range(SLOTS * numbers)]
    line = Division(config)

    @always_comb
    def judge():
        negative.next = answer.left < 0 and answer.right < 0
        change.next = (answer.left < 0) != (answer.right < 0)
        place.next = concat(answer.slot, answer.number)

    answered = line.joined(value=answer.left, growth=answer.growth)

    @always(clk.posedge)
    def keep_line():
        if answer.valid and answer.half_line and change:
            kept[place].next = answered

    @always(clk.posedge)
    def keep_entry():
        if opened:
            entries[slot].next = met.word

    @always_comb
    def see_slot():
        remaining.next = crossings[numbers:]
        known.next = complete[0]
        refused.next = rejected[0]
        in_turn.word.next = entries[0]
        if turn:
            remaining.next = crossings[:numbers]
            known.next = complete[1]
            refused.next = rejected[1]
            in_turn.word.next = entries[1]
        free.next = not pending[slot]
        idle.next = pending == 0

    @always_comb
    def choose_line():
        lowest.next = 0
        for i in range(numbers - 1, -1, -1):
            if remaining[i]:
                lowest.next = i

    @always_comb
    def address():
        asked.next = concat(turn, lowest)

    @always_comb
    def decide():
        over.next = (state == ClipState.LOOK) and known and (refused or start >= stop or remaining == 0)
        crossing.next = (state == ClipState.LOOK) and known and not (refused or start >= stop or remaining == 0)

    @always_comb
    def start_division():
        line.word.next = kept[asked]
        asks.divide.next = crossing

    @always_comb
    def show_division():
        asks.division.word.next = line.word

    @always(clk.posedge)
    def advance():
        if reset:
            state.next = ClipState.LOOK
        elif crossing:
            state.next = ClipState.DIVIDE
        elif answer.divided:
            state.next = ClipState.LOOK

    @always(clk.posedge)
    def use_slots():
        if reset:
            pending.next = 0
            complete.next = 0
            turn.next = False
        else:
            if opened:
                pending.next[slot] = True
            if answer.valid and answer.half_line and answer.last:
                complete.next[answer.slot] = True
            if over:
                pending.next[turn] = False
                complete.next[turn] = False
                turn.next = not turn

    @always(clk.posedge)
    def note():
        if opened:
            rejected.next[slot] = False
            if slot:
                crossings.next[:numbers] = 0
            else:
                crossings.next[numbers:] = 0
        if answer.valid and answer.half_line:
            if negative:
                rejected.next[answer.slot] = True
            if change:
                crossings.next[place] = True
        if crossing:
            crossings.next[asked] = False

    @always_comb
    def find_edge():
        border.next = (chain.start + answer.columns) % (1 << width)

    @always(clk.posedge)
    def clip():
        if over or (pending == 0):
            start.next = chain.start
            stop.next = chain.stop
        elif answer.divided and (state == ClipState.DIVIDE):
            if rises and (border > start):
                start.next = border
            elif (not rises) and (border < stop):
                stop.next = border
        if crossing:
            rises.next = line.value < 0

    found = entry.joined(
        index=in_turn.index, axis=in_turn.axis, back=in_turn.back, distance=in_turn.distance, start=start, stop=stop
    )

    @always(clk.posedge)
    def present():
        append.next = over and (not refused) and (start < stop) and not reset
        entry.word.next = found

    return instances()
