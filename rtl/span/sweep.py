# SPDX-License-Identifier: MIT
"""The end of a span, and the entry that is seen after it."""

from myhdl import Signal, always, always_comb, block, concat, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import column_bits, line_factor_bits
from raycaster.rtl.span.records import NUMBER_BITS, Entry

SweepState = enum("IDLE", "SCAN", "ORDER", "CROSS", "RIVAL", "NEXT")


@block
def sweep(
    clk, reset, start, gap, column, chain_stop, winner, count, tested, asks, answer, read, place, stop, inherited, heir,
    done, config: Configuration,
):  # fmt: skip
    """Find where the span that begins at a column ends, and its heir, in one pass over a chain's entries.

    The winner is seen at the column: of all entries there, its t is the least, and its index in a tie. It is seen
    until another one takes over, or until it ends. Entry i is seen before entry j at column c, if both are met there,
    where N[j] e[i](c) - N[i] e[j](c) - (i > j) is not negative, which is a line. On the same axis that is the order
    of N and index, without a line. In a gap nothing is seen; it lasts to the next entry, which may begin at once.

    An entry is compared with the winner and with the present stop in the cycle after it was read, and judged in the
    next cycle. One that follows takes a cycle more, as it may change the stop.

    Args:
        reset: flag; synchronous reset to idle.
        start: strobe; begins a pass while idle. All entries are in the table.
        gap: flag; nothing is seen at the column, and winner is ignored. Only entries may be met there that begin there.
        column: unsigned, `column_bits` bits; the span's first column.
        chain_stop: unsigned, `column_bits` bits; the column after the chain's last.
        winner: `Entry` that is seen at column.
        count: unsigned, `count_bits` bits; number of the chain's entries. All inputs from gap on are constant from the
            cycle after start to done.
        tested: `Entry`; the entry that was read last.
        asks: output `Asks`.
        answer: `Answer`.
        read: output strobe; the table must read the entry at place.
        place: unsigned output, `index_bits` bits; valid with read.
        stop: unsigned output, `column_bits` bits; the column after the span's last. Valid from done to the next start.
        inherited: output flag; an entry is seen at stop. Valid like stop.
        heir: output `Entry`, if inherited: the one that is seen at stop. Valid like stop.
        done: output strobe.
    """
    width, factor_bits = column_bits(config), line_factor_bits(config)

    state = Signal(SweepState.IDLE)
    begins, held, asks_rival, divided, crossed = (bit() for _ in range(5))
    rest, left_over = unsigned(len(count)), unsigned(len(count))
    # The entry that is compared with stop, and how it compares with the winner.
    present = Entry(config)
    left, left_1, at, last, bound, bound_1, crossing, found_at, first_stop, limit = (unsigned(width) for _ in range(10))
    ahead, opens, in_time, meets, nearer, same, outlasts, shortened = (bit() for _ in range(8))
    tested_rank, winner_rank, present_rank, heir_rank = (
        unsigned(len(winner.distance) + len(winner.index)) for _ in range(4)
    )
    in_time_1, meets_1, nearer_1, same_1, outlasts_1, soon_1 = (bit() for _ in range(6))
    judging, soon, soon_after, sooner, found, here, ordered, changes, crosses = (bit() for _ in range(9))
    take, settled, advance, rivalled, earlier, nearer_heir, same_heir, follows = (bit() for _ in range(8))
    rival = Entry(config)
    asked_left, asked_right, right = (unsigned(width) for _ in range(3))
    to_rival, to_present = signed(factor_bits), signed(factor_bits)
    later = bit()
    none, no_number = tied(0, 1), tied(0, NUMBER_BITS)

    # The first column of interest is where both are met, as an entry begins before it ends.
    see_ahead = assign(ahead, lambda: tested.start >= column)
    see_left = assign(left, lambda: tested.start if tested.start >= column else column)

    # Of two entries on one axis, the one with the lower rank is nearer.
    @always_comb
    def see_ranks():
        tested_rank.next = concat(tested.distance, tested.index)
        winner_rank.next = concat(winner.distance, winner.index)
        present_rank.next = concat(present.distance, present.index)
        heir_rank.next = concat(heir.distance, heir.index)

    @always_comb
    def compare():
        same.next = tested.axis == winner.axis
        nearer.next = tested_rank < winner_rank
        meets.next = tested.start < winner.stop
        outlasts.next = tested.stop > winner.stop

    # An entry opens if it has not ended; in a gap, if it has not begun before.
    see_open = assign(opens, lambda: ahead if gap else (tested.index != winner.index) and (tested.stop > column))

    # An entry that does not begin too late; it may also begin where the winner ends.
    find_first_stop = assign(first_stop, lambda: chain_stop if gap else winner.stop)
    find_limit = assign(limit, lambda: first_stop if begins else stop)
    see_time = assign(in_time, lambda: opens and (tested.start <= limit))

    # left < limit, without a wait for left.
    see_soon = assign(soon, lambda: (tested.start < limit) and (column < limit))

    count_down = assign(left_over, lambda: count if begins else rest)

    @always(clk.posedge)
    def keep_present():
        begins.next = start and not reset
        if reset:
            held.next = False
        elif begins or advance:
            held.next = left_over != 0
            rest.next = left_over
            if left_over != 0:
                rest.next = left_over - 1
            present.word.next = tested.word
            left_1.next, in_time_1.next, meets_1.next = left, in_time, meets
            nearer_1.next, same_1.next, outlasts_1.next, soon_1.next = nearer, same, outlasts, soon

    # Where the entry would come first: where both are met, or after a division at the crossing.
    find_place = assign(at, lambda: crossing if state == SweepState.CROSS else left_1)

    @always_comb
    def see_judging():
        judging.next = (state == SweepState.SCAN) and held
        follows.next = outlasts_1 and not shortened

    # While an entry is compared, stop does not change; so both places are compared with it before.
    choose_sooner = assign(sooner, lambda: soon_after if state == SweepState.CROSS else soon_1)

    @always_comb
    def compare_heir():
        same_heir.next = present.axis == heir.axis
        nearer_heir.next = present_rank < heir_rank

    @always(clk.posedge)
    def see_crossing():
        divided.next = answer.divided and not reset
        crossed.next = divided and not reset
        soon_after.next = crossing < stop
        if answer.divided:
            crossing.next = (left_1 + answer.columns) % (1 << width)

    # The column at which the entry would follow, if it does: here, at left_1, after a division, or at stop.
    @always_comb
    def find():
        found.next = here.next = ordered.next = False
        if judging:
            if gap or not meets_1:
                found.next = in_time_1
                here.next = True
            elif same_1:
                found.next = in_time_1 and (nearer_1 or follows)
                here.next = nearer_1
            else:
                ordered.next = in_time_1
        elif (state == SweepState.ORDER) and answer.valid:
            here.next = answer.left >= 0
            found.next = (answer.left >= 0) or ((answer.right < 0) and follows)
        elif state == SweepState.CROSS:
            here.next = True
            found.next = crossed

    find_column = assign(found_at, lambda: at if here else stop)
    see_change = assign(changes, lambda: (answer.left < 0) and (answer.right >= 0))

    @always_comb
    def start_division():
        crosses.next = asks.divide.next = (state == SweepState.ORDER) and answer.valid and changes

    see_earlier = assign(earlier, lambda: here and sooner)

    # Two that follow at the same column are compared there.
    @always_comb
    def settle():
        take.next = rivalled.next = False
        if found:
            if earlier or not inherited:
                take.next = True
            elif same_heir:
                take.next = nearer_heir
            else:
                rivalled.next = True
        elif (state == SweepState.RIVAL) and answer.valid:
            take.next = answer.left >= 0

    @always_comb
    def see_settled():
        settled.next = False
        if state == SweepState.SCAN:
            settled.next = held and not ordered
        elif state == SweepState.NEXT:
            settled.next = True
        elif state != SweepState.IDLE:
            settled.next = answer.valid

    @always_comb
    def see_advance():
        advance.next = settled and not (found or crosses)
        done.next = (state == SweepState.SCAN) and (rest == 0) and not (held or begins)

    fetch = assign(read, lambda: start or begins or advance)

    @always(clk.posedge)
    def step():
        asks_rival.next = rivalled and not reset
        if reset:
            state.next = SweepState.IDLE
        elif start or advance:
            state.next = SweepState.SCAN
        elif done:
            state.next = SweepState.IDLE
        elif rivalled:
            state.next = SweepState.RIVAL
        elif found:
            state.next = SweepState.NEXT
        elif ordered:
            state.next = SweepState.ORDER
        elif crosses:
            state.next = SweepState.CROSS

    @always(clk.posedge)
    def count_entries():
        if reset or done:
            place.next = 0
        elif read:
            place.next = (place + 1) % (1 << len(place))

    # bound is the last column in which winner and entry may be met, or the one after it if the winner is still there.
    @always(clk.posedge)
    def keep():
        if begins:
            inherited.next = shortened.next = False
            stop.next, bound.next = first_stop, bound_1
        elif take:
            inherited.next = True
            heir.word.next = present.word
            if found:
                stop.next = found_at
            if found and earlier:
                shortened.next = True
                bound.next = found_at

    @always_comb
    def see_bounds():
        bound_1.next = (winner.stop - 1) % (1 << width)
        last.next = (present.stop - 1) % (1 << width)

    see_right = assign(right, lambda: last if last < bound else bound)
    choose_rival = assign(rival.word, lambda: heir.word if state == SweepState.RIVAL else winner.word)
    choose_asked_left = assign(asked_left, lambda: stop if state == SweepState.RIVAL else left_1)
    choose_asked_right = assign(asked_right, lambda: stop if state == SweepState.RIVAL else right)

    @always_comb
    def extend():
        to_rival.next, to_present.next = rival.distance, present.distance
        later.next = present.index > rival.index

    asked = asks.query.joined(
        from_light=none, left=asked_left, right=asked_right, strict=later, axis_1=present.axis, back_1=present.back,
        factor_1=to_rival, axis_2=rival.axis, back_2=rival.back, factor_2=to_present, half_line=none,
        last=none, number=no_number,
    )  # fmt: skip
    dividend = asks.division.joined(value=answer.left, growth=answer.growth)

    @always_comb
    def request():
        asks.ask.next = ordered or asks_rival
        asks.query.word.next, asks.division.word.next = asked, dividend

    return instances()
