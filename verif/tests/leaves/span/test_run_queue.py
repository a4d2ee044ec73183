# SPDX-License-Identifier: MIT
"""`run_queue`: full, empty and in between; runs come and go at any pace, also in every cycle; resets in the middle."""

from list_vectors import PIXEL_BITS, Queue, entry
from vectors import by

from raycaster.hdl.signals import bit
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.run_queue import run_queue

FILLING = 40
"""Cycles after which all words of the memories have been written."""


@by(columns=[1, 5], places=[5, 8], bank=[2048, 4, 2], pace=[(0.0, 0.0), (0.3, 0.7), (0.7, 0.3)])
def test_run_queue(columns, places, bank, pace, leaf_of, random):
    made = {name: lambda: ListEntry(9, PIXEL_BITS) for name in ("run", "head")}
    sizes = {"columns": columns, "places": places, "bank": bank}
    leaf, model = leaf_of(run_queue, offered=bit, **sizes, **made), Queue(**sizes)
    leaf.case({"reset": 1})
    levels, streak, longest = set(), 0, 0
    coming, going = pace
    for cycle in range(1500):
        reset = int(cycle >= FILLING and random.random() < 0.005)
        # Times in which nothing comes or nothing goes fill and empty the queue.
        phase = cycle // 100 % 3
        run = (int(random.integers(10)), int(random.integers(1 << PIXEL_BITS)))
        valid = int(cycle < FILLING or random.random() >= (coming if phase != 1 else 0.9))
        take = int(model.head is not None and random.random() >= (going if phase != 2 else 0.95))
        leaf.case({"reset": reset, "valid": valid, **entry("run", run), "take": take})
        leaf.expect({"ready": model.ready, "room": model.room, "offered": model.head is not None})
        leaf.expect(entry("head", model.head) if model.head else None)
        streak = streak + 1 if take else 0
        longest = max(longest, streak)
        model.clock(run if valid else None, bool(take), bool(reset))
        levels.add(len(model.waiting))
    leaf.check(settled=FILLING)
    assert levels == set(range(places + 1))
    assert pace != (0.0, 0.0) or longest > 50
