# SPDX-License-Identifier: MIT
"""The end of a span, and the entry that is seen after it."""

from myhdl import Signal, always, always_comb, block, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, signed, tied, unsigned
from raycaster.rtl.common.widths import column_bits, line_factor_bits
from raycaster.rtl.span.records import NUMBER_BITS, Entry

SweepState = enum("IDLE", "SCAN", "ORDER", "CROSS", "RIVAL")


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

    Args:
        clk: the clock.
        reset: flag; synchronous reset to idle.
        start: strobe; begins a pass while idle.
        gap: flag; nothing is seen at the column, and winner is ignored. Only entries may be met there that begin there.
        column: unsigned, `column_bits` bits; the span's first column.
        chain_stop: unsigned, `column_bits` bits; the column after the chain's last.
        winner: `Entry` that is seen at column.
        count: unsigned, `count_bits` bits; number of the chain's entries. All inputs above are constant from start to
            done.
        tested: `Entry`; the entry that was read last.
        asks: output `Asks`.
        answer: `Answer`.
        read: output strobe; the table must read the entry at place.
        place: unsigned output, `index_bits` bits; valid with read.
        stop: unsigned output, `column_bits` bits; the column after the span's last. Valid from done to the next start.
        inherited: output flag; an entry is seen at stop. Valid like stop.
        heir: output `Entry`, if inherited: the one that is seen at stop. Valid like stop.
        done: output strobe.
        config: the design.
    """
    width, factor_bits = column_bits(config), line_factor_bits(config)

    state = Signal(SweepState.IDLE)
    rest = unsigned(len(count))
    left, left_1, right, last, bound, crossing, found_at = (unsigned(width) for _ in range(7))
    found, take, settled, advance, rivalled, ordered, changes, crosses = (bit() for _ in range(8))
    scanning, in_time, nearer, nearer_heir, same, same_heir, follows, meets = (bit() for _ in range(8))
    rival = Entry(config)
    asked_left, asked_right = unsigned(width), unsigned(width)
    to_rival, to_tested = signed(factor_bits), signed(factor_bits)
    later = bit()
    none, no_number = tied(0, 1), tied(0, NUMBER_BITS)

    @always_comb
    def see_left():
        left.next = column
        if tested.start > column:
            left.next = tested.start

    @always_comb
    def compare():
        same.next = tested.axis == winner.axis
        same_heir.next = tested.axis == heir.axis
        nearer.next = (tested.distance < winner.distance) or (
            (tested.distance == winner.distance) and (tested.index < winner.index)
        )
        nearer_heir.next = (tested.distance < heir.distance) or (
            (tested.distance == heir.distance) and (tested.index < heir.index)
        )

    # An entry that neither begins too late nor has ended; it may also begin where the winner ends.
    @always_comb
    def see_time():
        scanning.next = (state == SweepState.SCAN) and (rest != 0)
        in_time.next = (tested.index != winner.index) and (left < tested.stop) and (left <= stop)
        follows.next = (stop == winner.stop) and (stop < tested.stop)
        meets.next = left < winner.stop

    @always_comb
    def see_crossing():
        crossing.next = (left_1 + answer.columns) % (1 << width)

    # The column at which the tested entry would follow, if it does.
    @always_comb
    def find():
        found.next = False
        found_at.next = stop
        ordered.next = False
        if scanning:
            if gap:
                found.next = (tested.start >= column) and (tested.start <= stop)
                found_at.next = tested.start
            elif in_time and meets:
                if not same:
                    ordered.next = True
                elif nearer:
                    found.next = True
                    found_at.next = left
                else:
                    found.next = follows
            else:
                found.next = in_time
        elif (state == SweepState.ORDER) and answer.valid:
            if answer.left >= 0:
                found.next = True
                found_at.next = left_1
            elif answer.right < 0:
                found.next = follows
        elif (state == SweepState.CROSS) and answer.divided:
            found.next = True
            found_at.next = crossing

    @always_comb
    def see_change():
        changes.next = (answer.left < 0) and (answer.right >= 0)

    @always_comb
    def start_division():
        crosses.next = (state == SweepState.ORDER) and answer.valid and changes
        asks.divide.next = (state == SweepState.ORDER) and answer.valid and changes

    # Two that follow at the same column are compared there.
    @always_comb
    def settle():
        take.next = False
        rivalled.next = False
        if found:
            if (found_at < stop) or not inherited:
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
            settled.next = not ordered
        elif state == SweepState.CROSS:
            settled.next = answer.divided
        elif state != SweepState.IDLE:
            settled.next = answer.valid

    @always_comb
    def see_advance():
        advance.next = settled and (rest != 0) and not (rivalled or crosses)
        done.next = (state == SweepState.SCAN) and (rest == 0)

    @always_comb
    def fetch():
        read.next = start or advance

    @always(clk.posedge)
    def step():
        if reset:
            state.next = SweepState.IDLE
        elif start or advance:
            state.next = SweepState.SCAN
        elif done:
            state.next = SweepState.IDLE
        elif rivalled:
            state.next = SweepState.RIVAL
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
        if start:
            rest.next = count
        elif advance:
            rest.next = rest - 1

    @always(clk.posedge)
    def keep():
        if start:
            inherited.next = False
            stop.next = winner.stop
            if gap:
                stop.next = chain_stop
        elif take:
            inherited.next = True
            if found:
                stop.next = found_at
            heir.word.next = tested.word
        if scanning:
            left_1.next = left

    # The last column in which both may be seen, up to the one after the span if the winner is still there.
    @always_comb
    def see_bounds():
        last.next = (tested.stop - 1) % (1 << width)
        bound.next = (stop - 1) % (1 << width)
        if stop < winner.stop:
            bound.next = stop

    @always_comb
    def see_right():
        right.next = bound
        if last < bound:
            right.next = last

    @always_comb
    def choose_rival():
        rival.word.next = winner.word
        asked_left.next = left
        asked_right.next = right
        if rivalled:
            rival.word.next = heir.word
            asked_left.next = stop
            asked_right.next = stop

    @always_comb
    def extend():
        to_rival.next = rival.distance
        to_tested.next = tested.distance
        later.next = tested.index > rival.index

    asked = asks.query.joined(
        from_light=none, left=asked_left, right=asked_right, strict=later, axis_1=tested.axis, back_1=tested.back,
        factor_1=to_rival, axis_2=rival.axis, back_2=rival.back, factor_2=to_tested, half_line=none,
        last=none, number=no_number,
    )  # fmt: skip
    crossed = asks.division.joined(value=answer.left, growth=answer.growth)

    @always_comb
    def request():
        asks.ask.next = ordered or rivalled
        asks.query.word.next = asked
        asks.division.word.next = crossed

    return instances()
