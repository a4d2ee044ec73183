# SPDX-License-Identifier: MIT
"""Leaf tests of `painter` and `run_joiner`: mixed colours, and runs that wait, join and end."""

from __future__ import annotations

import pytest
from span_vectors import span_config
from vectors import by

from raycaster.hdl.signals import bit
from raycaster.rtl.span.painter import painter
from raycaster.rtl.span.records import Run
from raycaster.rtl.span.run_joiner import run_joiner


@by(patterns=[False, True], reflections=[0, 1, 4])
def test_painter(patterns, reflections, leaf_of, random):
    """Mixed colours of all levels; with patterns, runs end where the colour of any level changes."""
    config = span_config(screen="tiny", rectangles=4, reflections=reflections, patterns=patterns)
    leaf = leaf_of(painter, config, step=bit)
    leaf.case({"reset": 1, "emit": 0, "run_ready": 0})
    held, stop = None, 0

    def cycle(inputs, outputs=None, run=None):
        """Add a cycle in which this run is offered to the register, and return whether it takes the run."""
        nonlocal held
        ready, takes = int(random.integers(4) > 0), run is not None and held is None
        emitted = int(takes and run["run_end"] == stop)
        leaf.case(inputs | {"run_ready": ready}, {"run_valid": int(held is not None), "emitted": emitted})
        leaf.expect(outputs)
        leaf.expect(held)
        held = run if takes else None if ready else held
        return takes

    for _ in range(leaf.some(120)):
        fewer = int(random.integers(reflections + 1))
        level, left, shares = int(random.integers(fewer + 1)), 4**fewer, []
        for number in range(level + 1):
            own = 4 if number == level else int(random.integers(5))
            shares.append(left * own // 4)
            left = left * (4 - own) // 4
        stop = int(random.integers(1, 65))
        cycle({"reset": 0, "emit": 1, "level": level, "stop": stop, "picture_reflections": fewer})
        place, inputs = -1, {"emit": 0}
        while place < stop:
            changes = [int(random.choice([stop, int(random.integers(place + 1, stop + 1))])) for _ in shares]
            colours = [random.choice([0, 255, *random.integers(256, size=3)], 3).tolist() for _ in shares]
            for number, (share, colour, change) in enumerate(zip(shares, colours, changes, strict=True)):
                surface = {"seen_share": share, "seen_colour": int.from_bytes(bytes(colour)), "next_column": change}
                cycle(inputs | surface, {"seen": number})
                inputs = {}
            place = min(changes) if patterns else stop
            mixed = bytes(
                sum(share * colour[channel] for share, colour in zip(shares, colours, strict=True)) // 4**fewer
                for channel in range(3)
            )
            if patterns:
                cycle({})
            while not cycle({}, {"place": place}, {"run_end": place, "run_colour": int.from_bytes(mixed)}):
                pass
            for number in range(level + 1 if place < stop else 0):
                for stepped in [0] * int(random.integers(3)) + [1]:
                    cycle({"stepped": stepped}, {"step": 1, "seen": number, "place": place})
            inputs = {"stepped": 0}
        cycle(inputs)
    leaf.check(spare=True)


@pytest.mark.parametrize("patience", [0, 0.3, 0.8])
def test_run_joiner(patience, leaf_of, random):
    """Runs of colours that differ in a bit, some without columns; each side waits at times.

    Nothing that waits changes. With a reset, no row is done.
    """
    config = span_config(screen="tiny")
    leaf = leaf_of(run_joiner, config, part=lambda: Run(config))
    leaf.case({"reset": 1, "part_valid": 0})
    rows = []
    for _ in range(12):
        ends = sorted({*random.integers(1, 64, int(random.integers(20))).tolist(), 64})
        again = random.choice([0, *ends[:-1]], int(random.integers(6))).tolist()
        colour = int(random.integers(1, 1 << 24))
        colours = [colour, *(colour ^ 1 << int(bit) for bit in random.integers(24, size=2))]
        rows.append([(end, colours[random.integers(3)]) for end in sorted(ends + again)])
    parts = [part for row in rows for part in row]
    # A model of both registers says when each part is taken.
    held = shown = None
    place, done, joined, offer, taken = 0, 0, [], False, False
    while place < len(parts) or held or shown or done:
        ready = int(random.random() >= patience)
        offer = place < len(parts) and ((offer and not taken) or random.random() >= patience)
        part = parts[place] if offer else (0, 0)
        last = held is not None and held[0] == 64
        vacant = ready or shown is None
        same = held is not None and held[1] == part[1]
        empty = part[0] == (held[0] if held else 0)
        leaves = held is not None and vacant and (last or (offer and not same and not empty))
        taken = offer and not last and (held is None or same or empty or vacant)
        leaf.case(
            {"reset": 0, "part_valid": int(offer), "part_end": part[0], "part_colour": part[1], "run_ready": ready},
            {"run_valid": int(shown is not None), "done": done},
        )
        leaf.expect({"part_ready": int(taken)}, when=offer)
        if shown:
            leaf.expect({"run_end": shown[0], "run_colour": shown[1]})
        done = int(shown is not None and ready and shown[0] == 64)
        if shown is not None and ready:
            joined.append(shown)
            shown = None
        if leaves:
            shown, held = held, None
        if taken:
            held, place = held if empty else part, place + 1
    wanted = []
    for row in rows:
        merged = []
        for end, colour in row:
            if end == (merged[-1][0] if merged else 0):
                continue
            if merged and merged[-1][1] == colour:
                merged.pop()
            merged.append((end, colour))
        wanted += merged
    assert joined == wanted, "the model is wrong"
    leaf.case({"part_valid": 1, "part_end": 64, "run_ready": 1})
    leaf.case({"part_valid": 0}, {"run_valid": 0})
    leaf.case({"reset": 1}, {"run_valid": 1, "run_end": 64, "done": 0})
    leaf.case({}, {"run_valid": 0, "done": 0})
    leaf.check()
