# SPDX-License-Identifier: MIT
"""Everything between the units and the monitor: two lists of runs, each a whole frame."""

from myhdl import always_comb, block, instances

from raycaster.hdl.signals import bit, bits_for, side_by_side, tied, unconnected, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.widths import entry_bits
from raycaster.rtl.span.frame_switch import frame_switch
from raycaster.rtl.span.list_player import list_player
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.row_collector import row_collector
from raycaster.rtl.span.row_dealer import row_dealer
from raycaster.rtl.span.run_memory import BANK_PLACES, LARGE_BANK
from raycaster.rtl.span.run_queue import run_queue


@block
def frame_list(
    clk, reset, scan, run, hold, take_scene, stop, first_row, next_row, start, done, valid, runs, ready, busy, events,
    shown, columns: int, rows: int, entries: int, units: int = 1, pixels: int = 1, queue: int = 0,
):  # fmt: skip
    """Let units draw each frame into one of two lists, and show the other.

    A single unit writes into the list itself. Several have a queue each, and start a row only if there is room for all
    its runs, so they never wait for ready.

    Args:
        scan: `Scan`, as in `list_player`.
        run: flag of the live `Picture`; read in the cycle after take_scene.
        hold: flag; no row is dealt, as the units are not ready for this frame. Only with more than one unit.
        take_scene: output strobe; the pending scene goes live.
        stop: output flag; the units must be reset, as the design was reset or their frame was abandoned in the cycle
            before.
        first_row: output strobe, as in `row_slope`; in the second cycle after take_scene.
        next_row: output strobe, as in `row_slope`.
        start: unsigned output, a bit for each unit; strobe, the unit draws the present row.
        done: unsigned, a bit for each unit; strobe, after the row's last run has been taken.
        valid: unsigned, a bit for each unit; its run is there.
        runs: unsigned; a `ListEntry` of each unit, side by side, that of unit 0 in the lowest bits.
        ready: unsigned output, a bit for each unit; its run is taken if valid.
        busy: output flag; a frame is being drawn.
        events: `FrameEvents`; output.
        shown: unsigned output; the pixels of a clock, as in `list_player`.
        columns: columns of a row.
        rows: rows of a frame.
        entries: entries of a list, an even number.
        units: number of units.
        pixels: pixels per clock, 1 or 2.
        queue: runs that a unit's queue holds, at least columns; not used with one unit.
    """
    pixel_bits = len(shown) // pixels

    new_frame, whole, full, upper, view_run, write, dropped, abandoned = (bit() for _ in range(8))
    offered, take = bit(), bit()
    place = unsigned(entry_bits(entries))
    turn = unsigned(bits_for(units)) if units > 1 else unconnected(1)
    head, entry = ListEntry(columns, pixel_bits), ListEntry(columns, pixel_bits)
    room = unsigned(units) if units > 1 else tied(1, 1)

    switch = frame_switch(
        clk, reset, start_screen=scan.start_screen, run=run, whole=whole, full=full, take_scene=take_scene,
        new_frame=new_frame, stop=abandoned, upper=upper, view_run=view_run, busy=busy, events=events,
    )  # fmt: skip
    dealer = row_dealer(
        clk, reset=dropped, new_frame=new_frame, room=room, done=done, first_row=first_row, next_row=next_row,
        start=start, rows=rows, units=units,
    )  # fmt: skip
    collector = row_collector(
        clk, reset=dropped, new_frame=new_frame, offered=offered, head=head, take=take, turn=turn,
        write=write, place=place, entry=entry, whole=whole, full=full, columns=columns, rows=rows, units=units,
        entries=entries,
    )  # fmt: skip
    player = list_player(
        clk, reset, scan=scan, upper=upper, view_run=view_run, write=write, write_place=place, written=entry,
        shown=shown, pixels=pixels, entries=entries, bank=LARGE_BANK if entries == LARGE_BANK else BANK_PLACES,
    )  # fmt: skip

    drop = assign(dropped, lambda: reset or abandoned)
    stop_units = register(clk, stop, lambda: dropped)

    if units == 1:

        @always_comb
        def connect():
            offered.next = valid != 0
            head.word.next, ready.next = runs, take

    else:
        queued = [ListEntry(columns, pixel_bits).cut(runs, i) for i in range(units)]
        heads = [ListEntry(columns, pixel_bits) for _ in range(units)]
        head_words = [one.word for one in heads]
        waits, rooms, readies = ([bit() for _ in range(units)] for _ in range(3))
        takes = unsigned(units)
        waiting = side_by_side(waits)
        all_room, all_ready = side_by_side(rooms), side_by_side(readies)
        # The units go on for a cycle, so their queues are emptied when they are reset.
        queues = [
            run_queue(
                clk, reset=stop, valid=valid(i), run=queued[i], take=takes(i), ready=readies[i], room=rooms[i],
                offered=waits[i], head=heads[i], columns=columns, places=queue,
            )
            for i in range(units)
        ]  # fmt: skip

        @always_comb
        def collect():
            offered.next = waiting[turn]
            head.word.next = head_words[turn]

        @always_comb
        def take_from():
            takes.next = 0
            if take:
                takes.next[turn] = True

        connect_ready = assign(ready, lambda: all_ready)
        connect_room = assign(room, lambda: 0 if hold else all_room)

    return instances()
