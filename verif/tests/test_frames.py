# SPDX-License-Identifier: MIT
"""The model of a frame's time, compared cycle by cycle with models of the blocks that have leaf tests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from list_vectors import Collector, Dealer, Queue, row_of

from raycaster.cli import scenes
from raycaster.golden.frames import FIRST_DEAL, frame_cycles
from raycaster.golden.spans import Row
from raycaster.scene import packaged_scenes


def any_row(random: np.random.Generator, columns: int) -> Row:
    """Return a row with runs at any time: seldom, or one in every few cycles."""
    count = int(random.choice([1, columns, random.integers(1, columns + 1)]))
    gaps = random.integers(1, int(random.choice([2, 3, 40])), size=count)
    taken = np.cumsum(gaps) + int(random.choice([1, 20, 100]))
    runs = [(end, (0, 0, 0)) for end, _ in row_of(random, columns, count)]
    return Row(runs, int(taken[-1]) + 1, [int(each) for each in taken])


def simulated(rows: Sequence[Row], columns: int, units: int, places: int) -> int:
    """Return the cycle of the write of the last entry, counted from StartScreen; the scene is live a cycle later."""
    dealer, collector = Dealer(len(rows), units), Collector(columns, len(rows), units, 10**6)
    queues, drawn = [Queue(columns, places) for _ in range(units)], [(0, Row())] * units
    cycle = 0
    while not (collector.written and collector.written[2]):
        cycle += 1
        ages = [cycle - begin for begin, _ in drawn]
        done = {unit for unit, (_, row) in enumerate(drawn) if row.cycles and row.cycles == ages[unit]}
        dealt = dealer.deal([units == 1 or queue.room for queue in queues], done)
        coming = [
            (row.runs[row.taken.index(age)][0], 0) if age in row.taken else None
            for (_, row), age in zip(drawn, ages, strict=True)
        ]
        head = coming[0] if units == 1 else queues[collector.turn].head
        take, turn = collector.take(head), collector.turn
        for unit, queue in enumerate(queues):
            queue.clock(coming[unit], units > 1 and take and unit == turn, reset=False)
        if dealer.started:
            unit, row = dealer.started
            drawn[unit] = cycle, rows[row]
        dealer.clock(cycle == 1, dealt, done, reset=False)
        collector.clock(cycle == 1, head, reset=False)
    return cycle + 1


@pytest.mark.parametrize("units", [1, 2, 3, 5])
@pytest.mark.parametrize("spare", [0, 1, 7])
def test_frame_cycles(units, spare, random):
    for _ in range(40):
        columns = int(random.integers(1, 20))
        rows = [any_row(random, columns) for _ in range(int(random.integers(1, 24)))]
        places = columns + spare
        assert frame_cycles(rows, columns, units, places) == simulated(rows, columns, units, places)


def test_a_frame_of_one_unit_takes_the_time_of_its_rows(random):
    rows = [any_row(random, 9) for _ in range(12)]
    assert frame_cycles(rows, 9) == FIRST_DEAL + sum(1 + row.cycles for row in rows)


def test_the_scenes_of_a_small_design(monkeypatch, capsys):
    """One scene needs more runs than the lists hold; in another, a frame takes longer than a refresh."""
    few = [packaged_scenes()[name] for name in ("boxes", "facing_mirrors", "pool")]
    monkeypatch.setattr(scenes, "packaged_for", lambda options: few)
    scenes.main(["--engine", "span", "--rows", "240", "--scale", "1", "--list", "8400"])
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    shown = {row[0]: " ".join(row[4:]) for row in rows if len(row) > 4}
    assert (
        shown.items() >= {"boxes": "60", "facing_mirrors": "60/2 = 30", "pool": "never: more than 8,400 runs"}.items()
    )
