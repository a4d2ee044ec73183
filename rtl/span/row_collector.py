# SPDX-License-Identifier: MIT
"""The rows of a frame, collected from the units into a list."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, bits_for, unsigned


@block
def row_collector(
    clk, reset, new_frame, offered, head, take, turn, write, place, entry, whole, full, columns: int, rows: int,
    units: int, entries: int,
):  # fmt: skip
    """Write the runs of a frame into a list, in the order of the picture, an entry per cycle.

    The rows are taken from the units in turn, as `row_dealer` deals them. A list is so nothing but its entries, one
    after the other: a row needs no address, since it begins where the row above ends, which is where an entry's end is
    the number of columns. Linked blocks would let a unit write its row at once, at the price of links, of an address
    for each row and of half a block that stays empty in each; and reading them would wait for links. Here, a unit that
    is ahead keeps its runs in its `run_queue`. A unit waits until the rows above are complete, so it does not wait for
    ever, as they don't wait for it.

    Args:
        reset: flag; synchronous, drops the frame.
        new_frame: strobe; a frame begins.
        offered: flag; head is the next run of the unit whose turn it is.
        head: `ListEntry`; read while offered.
        take: output strobe; head has been taken.
        turn: unsigned output; the unit whose row is collected. Only with more than one unit.
        write: output strobe; entry belongs to the list.
        place: unsigned output, `entry_bits` bits; number of the entry. Valid with write.
        entry: `ListEntry`; output, valid with write.
        whole: output strobe; with write of the frame's last entry.
        full: output flag; there is one more run, but no more place in the list. The frame must be dropped.
        columns: columns of a row.
        rows: rows of a frame.
        units: number of units.
        entries: entries of a list.
    """
    last_unit, last_place = units - 1, entries - 1

    rows_left = unsigned(bits_for(rows + 1))
    next_place = unsigned(len(place))
    wanted, ends = bit(), bit()
    # Whether rows are left, and places, as the queues wait for these.
    collecting, fits = bit(), bit()

    @always_comb
    def judge():
        wanted.next = offered and collecting
        ends.next = head.end == columns

    @always_comb
    def collect():
        take.next = wanted and fits
        full.next = wanted and not fits

    @always(clk.posedge)
    def count():
        if reset:
            rows_left.next = 0
            collecting.next = False
        elif new_frame:
            rows_left.next = rows
            collecting.next = True
        elif take and ends:
            rows_left.next = rows_left - 1
            collecting.next = rows_left != 1

    # Places are don't care when a frame is dropped, so the way from the list's end does not come here.
    @always(clk.posedge)
    def count_places():
        if new_frame:
            fits.next = True
            next_place.next = 0
        elif take:
            fits.next = next_place != last_place
            next_place.next = (next_place + 1) % (1 << len(next_place))

    if units > 1:

        @always(clk.posedge)
        def alternate():
            if new_frame:
                turn.next = 0
            elif take and ends:
                if turn == last_unit:
                    turn.next = 0
                else:
                    turn.next = turn + 1

    @always(clk.posedge)
    def store():
        write.next = take and not reset
        whole.next = take and ends and (rows_left == 1) and not reset
        place.next, entry.word.next = next_place, head.word

    return instances()
