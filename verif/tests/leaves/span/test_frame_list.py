# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that deal rows to units and collect their runs in a list."""

from collections import Counter

import pytest
from list_vectors import (
    PIXEL_BITS,
    Beam,
    Collector,
    Dealer,
    Queue,
    Unit,
    any_frame,
    any_row,
    entry,
    list_screen,
    packed,
    pixels_of,
    side_by_side,
)
from vectors import by, named

from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.rtl.common.interfaces import FrameEvents, Scan
from raycaster.rtl.common.widths import entry_bits
from raycaster.rtl.span.frame_list import frame_list
from raycaster.rtl.span.frame_switch import frame_switch
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.row_collector import row_collector
from raycaster.rtl.span.row_dealer import row_dealer
from raycaster.sim.register_model import Switch


def started_row(dealer: Dealer) -> dict[str, int]:
    """Return the outputs of a dealer that start a row."""
    return {"next_row": int(dealer.started is not None), "start": 1 << dealer.started[0] if dealer.started else 0}


@by(rows=[1, 13], units=[1, 2, 3, 5])
def test_row_dealer(rows, units, leaf_of, random):
    """Units that are busy, idle or without room for any time; frames that are dropped in the middle."""
    ports = {"room": units, "done": units, "start": lambda: unsigned(units)}
    leaf, model = leaf_of(row_dealer, rows=rows, units=units, **ports), Dealer(rows, units)
    leaf.case({"reset": 1})
    finished = at_once = 0
    for _ in range(3000):
        reset = int(random.random() < 0.01)
        idle = model.row == rows or not (model.dealing or model.settles or model.first_row)
        new_frame = int(idle and not model.busy and random.random() < 0.3)
        started = {unit for unit, _ in [model.started or (-1, 0)]}
        done = {unit for unit in model.busy - started if random.random() < 0.3}
        room = [random.random() < 0.8 for _ in range(units)]
        dealt = model.deal(room, done)
        inputs = {"room": sum(flag << unit for unit, flag in enumerate(room)), "done": sum(1 << unit for unit in done)}
        leaf.case({"reset": reset, "new_frame": new_frame, **inputs})
        leaf.expect({"first_row": model.first_row, **started_row(model)})
        at_once += dealt in done
        model.clock(bool(new_frame), dealt, done, bool(reset))
        finished += dealt is not None and model.row == rows
    leaf.check(settled=1)
    assert finished > 20
    assert at_once > 20 or rows == 1 or units > 2


FEW_COLUMNS, FEW_ROWS, FEW_ENTRIES = 6, 3, 10


@by(units=[1, 2, 3], pause=[0.0, 0.5])
def test_row_collector(units, pause, leaf_of, random):
    """Rows of any number of runs, lists exactly full and with a run too many, resets in the middle."""
    width = entry_bits(FEW_ENTRIES)
    made = {name: lambda: ListEntry(FEW_COLUMNS, PIXEL_BITS) for name in ("head", "entry")}
    sizes = {"columns": FEW_COLUMNS, "rows": FEW_ROWS, "units": units, "entries": FEW_ENTRIES}
    ports = {"offered": bit, "place": width, "turn": bits_for(units)}
    leaf = leaf_of(row_collector, **sizes, **ports, **made)
    model = Collector(**sizes)
    leaf.case({"reset": 1})
    runs, ends = [], set()
    for _ in range(3000):
        reset = int(leaf.cycle > 1 and random.random() < 0.005)
        new_frame = int(leaf.cycle == 1 or (not reset and model.rows_left == 0 and random.random() < 0.3))
        head = runs[0] if runs and random.random() >= pause else None
        full = model.full(head)
        leaf.case({"reset": reset or int(full), "new_frame": new_frame, "offered": head is not None})
        leaf.stimulus[-1] |= entry("head", head or (int(random.integers(FEW_COLUMNS + 1)), 0))
        leaf.expect({"take": model.take(head), "full": full, "write": model.written is not None})
        leaf.expect({"whole": model.written is not None and model.written[2]})
        leaf.expect({"turn": model.turn}, when=units > 1 and model.rows_left)
        if model.written:
            leaf.expect({"place": model.written[0], **entry("entry", model.written[1])})
            if model.written[2]:
                ends.add(len(model.taken))
        if model.take(head):
            runs.pop(0)
        if full:
            ends.add("full")
        model.clock(bool(new_frame), head, bool(reset or full))
        if new_frame:
            # After the frame comes a run that belongs to none.
            runs = [run for _ in range(FEW_ROWS + 1) for run in any_row(random, FEW_COLUMNS)]
        elif reset or full:
            runs = []
    leaf.check(settled=3)
    assert {FEW_ROWS, FEW_ENTRIES, "full"} <= ends


def test_frame_switch(leaf_of, random):
    """Frames in time, late ones, abandoned and black ones, with any number of cycles in between."""
    leaf, model = leaf_of(frame_switch, events=FrameEvents), Switch()
    leaf.case({"reset": 1})
    seen = dict.fromkeys(("drawn", "shown", "again", "late", "list_full", "black"), 0)
    for number in range(6000):
        cycle = leaf.cycle
        reset = int(random.random() < 0.002)
        start_screen = random.random() < (0.3 if model.state == "wait" else 0.04)
        whole, full, run = (bool(random.random() < chance) for chance in (0.05, 0.02, 0.8))
        whole, full = whole and model.state == "draw", full and model.state == "draw" and not whole
        leaf.case({"reset": reset, "start_screen": start_screen, "run": run, "whole": whole, "full": full})
        events = model.events(start_screen, whole, full, cycle)
        new_frame, take_scene = model.state == "begin" and run, model.state == "wait" and start_screen
        leaf.expect(named("events", events))
        leaf.expect({"take_scene": take_scene, "new_frame": new_frame, "stop": model.state == "draw" and full})
        leaf.expect({"upper": model.upper, "view_run": model.shown is not None})
        seen = {name: seen[name] + bool(events.get(name)) for name in seen}
        seen["black"] += model.state == "begin" and not run
        model.clock(start_screen, run, number, whole, full, cycle)
        if reset:
            model.reset()
    leaf.check(settled=1)
    assert min(seen.values()) > 20


COLUMNS, ROWS, ENTRIES = 8, 4, 18


@pytest.mark.parametrize("pace", ["quick", "mixed", "late"])
@pytest.mark.parametrize(
    ("units", "pixels", "doubling", "clocks", "queue"),
    [(1, 1, 1, 1, 0), (1, 1, 2, 2, 0), (2, 1, 2, 1, 8), (3, 1, 1, 2, 11), (1, 2, 1, 1, 0), (3, 2, 1, 1, 16)],
)
def test_frame_list(units, pixels, doubling, clocks, queue, pace, leaf_of, random):
    """Every picture that it shows is a whole one.

    Frames are in time or late, fill their list exactly or have a run too many, or are black; resets come in the middle.
    """
    width = len(ListEntry(COLUMNS, PIXEL_BITS).word)
    sizes = {"columns": COLUMNS, "rows": ROWS, "entries": ENTRIES, "units": units}
    leaf = leaf_of(
        frame_list, scan=Scan, events=FrameEvents, start=lambda: unsigned(units), done=units, valid=units, ready=units,
        runs=units * width, shown=pixels * PIXEL_BITS, pixels=pixels, queue=queue, **sizes,
    )  # fmt: skip
    screen = list_screen(COLUMNS, ROWS, doubling, clocks)
    beam, switch, dealer = Beam(screen, pixels), Switch(), Dealer(ROWS, units)
    collector = Collector(COLUMNS, ROWS, units, ENTRIES)
    queues = [Queue(COLUMNS, queue) for _ in range(units)]
    drawers = [Unit(random) for _ in range(units)]
    frame, run, seen, stops = [], 0, Counter(), True
    for _ in range(2):
        leaf.case({"reset": 1})
    for _ in range(leaf.some(40) * beam.period):
        cycle = leaf.cycle
        reset = random.random() < 0.1 / beam.period
        scan = beam.scan()
        start_screen = bool(scan["start_screen"])
        done = {number for number, drawer in enumerate(drawers) if drawer.done}
        offered = [drawer.runs[0] if drawer.offers else None for drawer in drawers]
        head = offered[0] if units == 1 else queues[collector.turn].head
        take, full = collector.take(head), collector.full(head)
        dealt = dealer.deal([one.room or units == 1 for one in queues], done)
        new_frame, take_scene = switch.state == "begin" and run, switch.state == "wait" and start_screen
        whole = collector.written is not None and collector.written[2]
        ready = [take] if units == 1 else [one.ready for one in queues]
        leaf.case({"reset": reset, "run": run, **named("scan", scan)})
        leaf.stimulus[-1]["done"] = sum(1 << number for number in done)
        leaf.stimulus[-1]["valid"] = sum(1 << number for number, one in enumerate(offered) if one)
        leaf.stimulus[-1]["runs"] = side_by_side([packed(one) if one else 0 for one in offered], width)
        if not reset:
            events = switch.events(start_screen, whole, full, cycle)
            leaf.expect({"take_scene": take_scene, "stop": stops, **named("events", events)})
            leaf.expect({"first_row": dealer.first_row, **started_row(dealer)})
            leaf.expect({"ready": sum(flag << number for number, flag in enumerate(ready))}, when=units > 1)
            leaf.expect({"ready": take}, when=units == 1)
            seen.update(name for name, value in events.items() if value and name != "time")
            seen["waits"] += units > 1 and not all(one.room for one in queues)
            seen["exactly full"] += whole and len(collector.taken) == ENTRIES
            if beam.place:
                row, column = beam.place
                picture = [0] * COLUMNS if switch.shown is None else pixels_of(switch.shown[row])
                leaf.expected[cycle + 1]["shown"] = side_by_side(picture[column : column + pixels], PIXEL_BITS)
                seen["pictures"] += switch.shown is not None and beam.place == (0, 0)
        dropped = bool(reset or full)
        for number, drawer in enumerate(drawers):
            taken = offered[number] is not None and ready[number]
            assert ready[number] or units == 1 or not drawer.runs  # with room for a row, a unit never waits
            queues[number].clock(offered[number], bool(number == collector.turn and take and units > 1), stops)
            starts = dealer.started is not None and dealer.started[0] == number
            drawer.clock(taken, frame[dealer.started[1]] if starts else None, stops)
        dealer.clock(bool(new_frame), dealt, done, dropped)
        collector.clock(bool(new_frame), head, dropped)
        if new_frame:
            frame = any_frame(random, COLUMNS, ROWS, ENTRIES)
            slow = 1 - ENTRIES / units / beam.period
            pause = {"quick": 0.0, "late": slow, "mixed": random.choice([0.0, 0.5, slow])}[pace]
            for drawer in drawers:
                drawer.pause = pause if random.random() < 0.7 else pause / 2
        switch.clock(start_screen, bool(run), frame, whole, full, cycle)
        if take_scene:
            run = int(random.random() < 0.9)
        beam.clock(reset)
        stops = dropped
        if reset:
            switch.reset()
            leaf.expected.pop(cycle + 1, None)
    leaf.expected.pop(leaf.cycle, None)
    leaf.check(settled=2)
    wanted = {"quick": {"drawn", "shown"}, "late": {"late", "again"}, "mixed": {"list_full", "exactly full"}}[pace]
    assert all(seen[name] > 0 for name in {*wanted, "pictures"}), seen
