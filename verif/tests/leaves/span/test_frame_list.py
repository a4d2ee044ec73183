# SPDX-License-Identifier: MIT
"""`frame_list` with units that draw at any pace, at a monitor: every picture that it shows is a whole one.

Frames are in time or late, fill their list exactly or have a run too many, or are black; resets come in the middle.
"""

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
    list_screen,
    packed,
    pixels_of,
    side_by_side,
)
from vectors import named

from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import FrameEvents, Scan
from raycaster.rtl.span.frame_list import frame_list
from raycaster.rtl.span.lists import ListEntry
from raycaster.sim.register_model import Switch

COLUMNS, ROWS, ENTRIES = 8, 4, 18


@pytest.mark.parametrize("pace", ["quick", "mixed", "late"])
@pytest.mark.parametrize(
    ("units", "pixels", "doubling", "clocks", "queue"),
    [(1, 1, 1, 1, 0), (1, 1, 2, 2, 0), (2, 1, 2, 1, 8), (3, 1, 1, 2, 11), (1, 2, 1, 1, 0), (3, 2, 1, 1, 16)],
)
def test_frame_list(units, pixels, doubling, clocks, queue, pace, leaf_of, random):
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
    frame, run, seen, stops = [], 0, Counter(), False
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
        start = dealer.start([one.room or units == 1 for one in queues], done)
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
            started = 0 if start is None else 1 << start
            leaf.expect({"first_row": dealer.first_row, "next_row": start is not None, "start": started})
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
        dropped, cleared = bool(reset or full), bool(reset or stops)
        for number, drawer in enumerate(drawers):
            taken = offered[number] is not None and ready[number]
            assert ready[number] or units == 1 or not drawer.runs  # with room for a row, a unit never waits
            queues[number].clock(offered[number], bool(number == collector.turn and take and units > 1), cleared)
            drawer.clock(taken, frame[dealer.row] if start == number else None, cleared)
        dealer.clock(bool(new_frame), start, done, dropped)
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
        stops = bool(full and not reset)
        if reset:
            switch.reset()
            leaf.expected.pop(cycle + 1, None)
    leaf.expected.pop(leaf.cycle, None)
    leaf.check(settled=1)
    wanted = {"quick": {"drawn", "shown"}, "late": {"late", "again"}, "mixed": {"list_full", "exactly full"}}[pace]
    assert all(seen[name] > 0 for name in {*wanted, "pictures"}), seen
