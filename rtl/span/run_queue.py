# SPDX-License-Identifier: MIT
"""The runs of a unit that wait for the rows above them."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, bits_for, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.span.read_ahead import read_ahead
from raycaster.rtl.span.run_memory import BANK_PLACES, read_latency, run_memory


@block
def run_queue(
    clk, reset, valid, run, take, ready, room, offered, head, columns: int, places: int, bank: int = BANK_PLACES
):  # fmt: skip
    """Queue the runs of a unit, so that it draws its next row while a row above is still being drawn by another unit.

    A unit that starts a row only if there is room never waits for ready, so a row takes the cycles that it takes alone.

    Args:
        reset: flag; synchronous, empties the queue.
        valid: flag; run is there.
        run: `ListEntry`; is taken in each cycle with valid and ready.
        take: strobe; head is replaced by the next run. Only while offered.
        ready: output flag, a register; the queue is not full.
        room: output flag, a register; there is room for all runs that a row can have.
        offered: output flag, a register; head is a run, at the earliest two cycles and `read_latency` after it was
            taken from the unit.
        head: `ListEntry`; output, the oldest run, valid while offered and constant until take.
        columns: columns of a row, its most runs.
        places: runs that fit, besides those that are read ahead; at least columns.
        bank: places of a bank of the memory.
    """
    last, most = places - 1, places - columns
    too_many, minus_one = most + 1, (1 << bits_for(places + 1)) - 1

    put, fetch, more = bit(), bit(), bit()
    write_place, read_place = (unsigned(bits_for(places)) for _ in range(2))
    unread, change = (unsigned(bits_for(places + 1)) for _ in range(2))
    shown = run.twin()

    memory = run_memory(
        clk, write=put, write_place=write_place, written=run, read=tied(1, 1), read_place=read_place, shown=shown,
        places=places, bank=bank,
    )  # fmt: skip
    reader = read_ahead(
        clk, restart=reset, first=tied(0, write_place), more=more, shown=shown, take=take, fetch=fetch,
        read_place=read_place, offered=offered, head=head, places=places,
        latency=read_latency(places, bank),
    )  # fmt: skip

    @always_comb
    def accept():
        more.next = unread != 0
        put.next = valid and ready

    @always(clk.posedge)
    def follow():
        if reset:
            write_place.next = 0
        elif put:
            if write_place == last:
                write_place.next = 0
            else:
                write_place.next = write_place + 1

    see_change = assign(change, lambda: minus_one if fetch else 1)

    @always(clk.posedge)
    def count():
        if reset:
            unread.next = 0
            ready.next = room.next = True
        elif put != fetch:
            ready.next = fetch or (unread != last)
            unread.next = (unread + change) % (1 << len(unread))
            if put and (unread == most):
                room.next = False
            elif fetch and (unread == too_many):
                room.next = True

    return instances()
