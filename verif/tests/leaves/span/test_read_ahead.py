# SPDX-License-Identifier: MIT
"""Leaf test of `read_ahead`: restarts at any place, with runs on their way; takes in every cycle, or seldom."""

from collections import deque

from list_vectors import PIXEL_BITS, entry, slots_of
from vectors import by

from raycaster.hdl.signals import bit, bits_for
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.read_ahead import read_ahead


@by(places=[5, 8], pause=[0.0, 0.6], latency=[2, 3, 5])
def test_read_ahead(places, pause, latency, leaf_of, random):
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
