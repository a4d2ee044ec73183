# SPDX-License-Identifier: MIT
"""Leaf tests of `sweep` and `entry_table`: spans against what is nearest in each column, with ties and crossings."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from span_vectors import NOTHING, chain_bench, span_config
from vectors import any_fields, by, by_axis, named

from raycaster.golden.spans import Chain, Drawing, Entry, Line, Rect, SpanModel
from raycaster.rtl.common.widths import count_bits
from raycaster.rtl.span.entry_table import entry_table
from raycaster.rtl.span.records import Entry as EntryRecord

COLUMNS = 64


def nearest(entries, column) -> Entry | None:
    """Return the entry that is seen at a column: the least t = N / e, and of equals the lowest index."""
    active = [one for one in entries if one.start <= column < one.stop]
    return min(active, key=lambda one: (Fraction(one.distance, one.ahead.at(column)), one.rect.index), default=None)


def any_entries(random, slope, count) -> list[Entry]:
    """Return entries in which slopes are ahead, with few different distances and ends."""
    entries, ends, same = [], random.integers(COLUMNS, size=3).tolist(), int(random.integers(COLUMNS))
    steepest = max(abs(line.at(column)) for line in slope for column in (0, COLUMNS - 1))
    for index in sorted(random.choice(count, int(random.integers(count + 1)), replace=False).tolist()):
        axis = int(random.integers(3))
        back = bool(random.integers(2))
        line = Line(-slope[axis].at_0, -slope[axis].growth) if back else slope[axis]
        ahead = [column for column in range(COLUMNS) if line.at(column) > 0]
        if not ahead:
            continue
        start, stop = sorted(
            random.choice([ahead[0], ahead[-1] + 1, *ends, *random.integers(COLUMNS, size=2)], 2).tolist()
        )
        start, stop = max(start, ahead[0]), min(stop, ahead[-1] + 1)
        distance = int(random.choice([64, 128, 192, int(random.integers(1, 512))]))
        if random.random() < 0.6 and line.at(same) > 0:
            # All of these are about as far away at one column.
            start, stop = (ahead[0], ahead[-1] + 1) if random.random() < 0.5 else (start, stop)
            distance = max(1, 500 * line.at(same) // (steepest + 1) + int(random.integers(2)))
        if start < stop:
            rect = Rect(index, axis, 0, (0, 0, 0), (0, 0, 0), 2, 0, 32, (0, 0, 0), (0, 0, 0))
            entries.append(Entry(rect, int(start), int(stop), distance, line))
    return entries


@pytest.mark.parametrize("count", [3, 12])
def test_sweep(count, leaf_of, random):
    """The spans of a chain, from the gap with which it begins to its end, in as many cycles as the model says."""
    config = span_config(screen="tiny", rectangles=count, reflections=1, turn=True)
    leaf = leaf_of(chain_bench, config)
    seen = {"spans": 0, "gaps": 0, "divisions": 0, "orders": 0}
    leaf.case({"reset": 1})
    for drawn in range(2000):
        if drawn >= leaf.some(300) and (leaf.few or min(seen.values()) > 10):
            break
        slope = [
            Line(int(random.integers(-3000, 3000)), int(random.choice([0, *random.integers(-60, 60, 3)])))
            for _ in range(3)
        ]
        if random.random() < 0.3:
            # Diagonals, on which planes of equal distance cross.
            slope[1] = Line(slope[0].at_0 - 20 * slope[0].growth, slope[0].growth + int(random.integers(3)))
        entries = any_entries(random, slope, count)
        chain = Chain(0, COLUMNS, (0, 0, 0), (False, False, False))
        held = by_axis("slope_", (one.at_0 for one in slope)) | by_axis("step_", (one.growth for one in slope))
        held |= {"chain_start": 0, "chain_stop": COLUMNS, "reset": 0}
        leaf.stimulus += [held | {"clear": 1}, {"clear": 0}]
        for one in entries:
            leaf.case(entry_inputs(one, slope, "given") | {"give": 1})
        leaf.case({"give": 0})
        column, winner = 0, None
        drawing = Drawing(SpanModel(NOTHING, (0, 0, 0), (0, 0, 0), COLUMNS, 0), tuple(slope))
        while column < COLUMNS:
            drawing.now = 0
            stop, heir = drawing.sweep(entries, chain, column, winner)
            assert all(nearest(entries, one) == winner for one in range(column, stop)), "the model is wrong"
            assert stop == COLUMNS or nearest(entries, stop) == heir, "the model is wrong"
            inputs = {"begin_sweep": 1, "gap": int(winner is None), "column": column}
            leaf.case(inputs | (entry_inputs(winner, slope, "winner") if winner else {}))
            leaf.stimulus += [{"begin_sweep": 0}] * drawing.now
            leaf.expected[leaf.cycle - 2] |= {"sweep_done": 0}
            leaf.expect({"sweep_done": 1, "swept_stop": stop, "inherited": int(heir is not None)})
            if heir:
                leaf.expect(entry_inputs(heir, slope, "heir"))
            seen["gaps" if winner is None else "spans"] += 1
            column, winner = stop, heir
        for name in ("divisions", "orders"):
            seen[name] += drawing.result.steps[name]
    leaf.check(spare=True)
    assert min(seen.values()) > (0 if leaf.few else 10), seen


def entry_fields(entry, slope) -> dict[str, int]:
    """Return the fields of an entry's record."""
    return {
        "index": entry.rect.index, "axis": entry.rect.axis, "back": int(entry.ahead != slope[entry.rect.axis]),
        "distance": entry.distance, "start": entry.start, "stop": entry.stop,
    }  # fmt: skip


def entry_inputs(entry, slope, prefix) -> dict[str, int]:
    """Return an entry as at a port."""
    return named(prefix, entry_fields(entry, slope))


@by(light=[False, True], reflections=[0, 3])
def test_entry_table(light, reflections, leaf_of, random):
    """Tables of all levels are apart, and with a light those of the shadows."""
    config = span_config(screen="tiny", rectangles=5, reflections=reflections, light=light)
    leaf = leaf_of(entry_table, config, stored=lambda: EntryRecord(config), number=count_bits(config), place=3)
    memory, record = {}, EntryRecord(config)
    places = [(*one, place) for one in product(range(1 + light), range(reflections + 1)) for place in range(5)]
    for shadows, level, place in places:
        entry = memory[shadows, level, place] = any_fields(random, record)
        leaf.case({"append": 1, "read": 0, "shadows": shadows, "level": level, "number": place} | named("entry", entry))
    leaf.case({"append": 0, "read": 1, "shadows": 0, "level": 0, "place": 0})
    shown = memory[0, 0, 0]
    for _ in range(200):
        shadows, level, place = places[int(random.integers(len(places)))]
        number = (place + 1) % 5
        append, read = [(0, 0), (0, 1), (1, 0)][int(random.integers(3))]
        entry = any_fields(random, record)
        asked = {"append": append, "read": read, "shadows": shadows, "level": level, "number": number, "place": place}
        leaf.case(asked | named("entry", entry), named("stored", shown))
        if read:
            shown = memory[shadows, level, place]
        if append:
            memory[shadows, level, number] = entry
    leaf.check(spare=True)
