# SPDX-License-Identifier: MIT
"""Leaf test of `run_memory` and its stages and banks: places are written and read in any order, or in turn."""

from list_vectors import PIXEL_BITS, entry, memory_cycles
from vectors import by

from raycaster.hdl.signals import bits_for
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.run_memory import read_latency, run_memory


@by(places=[1, 6, 8, 67], bank=[128, 4, 2])
def test_run_memory(places, bank, leaf_of, random):
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
