# SPDX-License-Identifier: MIT
"""Reading of consecutive runs ahead of their use, as a block RAM takes its time."""

from myhdl import always, always_comb, block, concat, instances

from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.hdl.verbs import assign, register


def slots_for(latency: int) -> int:
    """Return a power of two of runs to read ahead: at least one per cycle from a run's fetch to the next of its slot.

    Args:
        latency: cycles from a place to its run.
    """
    return 1 << bits_for(latency + 2)


@block
def read_ahead(
    clk, restart, first, more, shown, take, fetch, read_place, offered, head, places: int, latency: int
):  # fmt: skip
    """Read the runs of consecutive places from a `run_memory`, and offer them in order, one per cycle.

    Args:
        restart: strobe; drops all runs that have been read, and goes on at first. Needed before the first run, which
            is offered from the latency and two cycles after it on.
        first: unsigned, below places; read with restart.
        more: flag; a run is at read_place. Only then it is fetched.
        shown: `ListEntry`; the run that was at read_place `latency` cycles ago.
        take: strobe; head is replaced by the next run. Only while offered.
        fetch: output strobe; a run is fetched, and will be offered.
        read_place: unsigned, like first; output register. It follows each fetch by one place; place 0 follows the last.
        offered: output flag, a register; head is a run.
        head: `ListEntry`; output, valid while offered and constant until take or restart.
        places: number of places.
        latency: cycles from a place to its run, at least two.
    """
    last, slot_count = places - 1, slots_for(latency)

    slots = [unsigned(len(shown.word)) for _ in range(slot_count)]
    put_slot, head_slot = (unsigned(bits_for(slot_count)) for _ in range(2))
    taken_slots, filled_slots = (unsigned(bits_for(slot_count + 1)) for _ in range(2))
    on_the_way = unsigned(latency)
    arrives = bit()

    ask = assign(fetch, lambda: more and (taken_slots != slot_count) and not restart)

    @always(clk.posedge)
    def advance():
        if restart:
            read_place.next = first
        elif fetch:
            if read_place == last:
                read_place.next = 0
            else:
                read_place.next = read_place + 1

    # A run reaches its slot at the end of the last of these cycles after its fetch.
    @always(clk.posedge)
    def travel():
        if restart:
            on_the_way.next = 0
        else:
            on_the_way.next = concat(on_the_way[latency - 1 :], fetch)

    arrive = assign(arrives, lambda: on_the_way[latency - 1])

    # taken_slots counts runs from their fetch to their take, filled_slots from their arrival.
    @always(clk.posedge)
    def count():
        if restart:
            taken_slots.next = filled_slots.next = 0
            offered.next = False
        else:
            if fetch and not take:
                taken_slots.next = taken_slots + 1
            elif take and not fetch:
                taken_slots.next = taken_slots - 1
            if arrives and not take:
                filled_slots.next = filled_slots + 1
            elif take and not arrives:
                filled_slots.next = filled_slots - 1
            if arrives:
                offered.next = True
            elif take:
                offered.next = filled_slots != 1

    fill = register(clk, slots[put_slot], lambda: shown.word, arrives)

    @always(clk.posedge)
    def circle():
        if restart:
            put_slot.next = head_slot.next = 0
        else:
            if arrives:
                put_slot.next = (put_slot + 1) % slot_count
            if take:
                head_slot.next = (head_slot + 1) % slot_count

    @always_comb
    def show_head():
        head.word.next = slots[head_slot]

    return instances()
