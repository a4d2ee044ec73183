# SPDX-License-Identifier: MIT
"""Leaf tests of the memories of runs, and what reads them ahead."""

from collections import deque

import pytest
from list_vectors import PIXEL_BITS, Queue, entry, memory_cycles, slots_of
from span_vectors import span_config
from vectors import by

from raycaster.hdl.signals import bit, bits_for
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.read_ahead import read_ahead
from raycaster.rtl.span.run_entry import run_entry
from raycaster.rtl.span.run_memory import read_latency, run_memory
from raycaster.rtl.span.run_queue import run_queue


@pytest.mark.parametrize("bits", [1, 5, 8])
def test_run_entry(bits, leaf_of, random):
    """The highest bits of each channel, by their number."""
    config = span_config(screen="tiny", colour_bits=bits)
    columns = config.screen_geometry.columns
    leaf = leaf_of(run_entry, config, entry=lambda: ListEntry(columns, 3 * bits))
    for _ in range(leaf.some(60)):
        end, ready, channels = int(random.integers(columns + 1)), int(random.integers(2)), random.integers(256, size=3)
        red, green, blue = (int(channel) >> 8 - bits for channel in channels)
        leaf.case({"run_end": end, "run_colour": int.from_bytes(bytes(channels.tolist())), "ready": ready})
        leaf.expect({"entry_end": end, "entry_pixel": (red << bits | green) << bits | blue, "run_ready": ready})
    leaf.check()


@by(places=[1, 6, 8, 67], bank=[128, 4, 2])
def test_run_memory(places, bank, leaf_of, random):
    """Places are written and read in any order, or in turn."""
    made = {name: lambda: ListEntry(9, PIXEL_BITS) for name in ("written", "shown")}
    ports = dict.fromkeys(("write_place", "read_place"), bits_for(places))
    leaf, held = leaf_of(run_memory, places=places, bank=bank, **ports, **made), {}
    latency = memory_cycles(places, bank)
    assert read_latency(places, bank) == latency
    for cycle in range(600):
        write = int(cycle < places or random.random() < 0.5)
        place = cycle if cycle < places else int(random.integers(places))
        read = int(random.choice([0, places - 1, cycle % places, random.integers(places)]))
        run = (int(random.integers(10)), int(random.integers(1 << PIXEL_BITS)))
        reads = int(cycle < places or random.random() < 0.8)
        leaf.case({"write": write, "write_place": place, **entry("written", run), "read": reads, "read_place": read})
        if not reads:
            leaf.expected[cycle + latency] |= entry("shown", (0, 0))
        elif read in held and not (write and place == read):
            leaf.expected[cycle + latency] |= entry("shown", held[read])
        if write:
            held[place] = run
    for cycle in range(latency):
        leaf.expected.pop(leaf.cycle + cycle, None)
    leaf.check(settled=places + latency)
    # Tools would take minutes for the initial values of a large list.
    assert not any("memory[i] =" in one.path.read_text() for one in leaf.modules)


@by(places=[5, 8], pause=[0.0, 0.6], latency=[2, 3, 5])
def test_read_ahead(places, pause, latency, leaf_of, random):
    """Restarts at any place, with runs on their way; takes in every cycle, or seldom."""
    made = {name: lambda: ListEntry(9, PIXEL_BITS) for name in ("shown", "head")}
    ports = dict.fromkeys(("first", "read_place"), bits_for(places))
    leaf = leaf_of(read_ahead, places=places, latency=latency, offered=bit, **ports, **made)
    memory = [(number % 10, int(random.integers(1 << PIXEL_BITS))) for number in range(places)]
    pipe, ahead, place = deque([0] * latency), [], 0
    streak = longest = restarts = 0
    for cycle in range(1500):
        restart = int(cycle == 0 or (cycle > 40 and random.random() < 0.03))
        first, more = int(random.integers(places)), int(cycle < 40 or random.random() < 0.9)
        offered = bool(ahead) and ahead[0][0] >= latency + 1
        take = int(offered and random.random() >= pause)
        fetch = more and len(ahead) < slots_of(latency) and not restart
        # What is shown is what was read a latency ago, be it of use or not.
        leaf.case({"restart": restart, "first": first, "more": more, "take": take, **entry("shown", memory[pipe[0]])})
        leaf.expect({"fetch": fetch, "offered": offered, "read_place": place}, when=cycle)
        leaf.expect(entry("head", ahead[0][1]) if offered else None)
        streak = streak + 1 if take else 0
        longest, restarts = max(longest, streak), restarts + (restart and bool(ahead))
        pipe = deque([*pipe, place][1:])
        ahead = [(age + 1, run) for age, run in ahead[take:]]
        if fetch:
            ahead.append((1, memory[place]))
            place = (place + 1) % places
        if restart:
            ahead, place = [], first
    leaf.check(settled=40)
    assert restarts > 10
    assert pause or longest > 20


FILLING = 40
"""Cycles after which all words of the memories have been written."""


@by(columns=[1, 5], places=[5, 8], bank=[2048, 4, 2], pace=[(0.0, 0.0), (0.3, 0.7), (0.7, 0.3)])
def test_run_queue(columns, places, bank, pace, leaf_of, random):
    """Full, empty and in between; runs come and go at any pace, also in every cycle; resets in the middle."""
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
