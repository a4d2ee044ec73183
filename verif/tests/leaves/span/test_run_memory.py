# SPDX-License-Identifier: MIT
"""Leaf test of `run_memory`: every place is written and read in any order, also one after the other."""

from list_vectors import PIXEL_BITS, entry
from vectors import by

from raycaster.hdl.signals import bits_for
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.run_memory import run_memory


@by(places=[1, 6, 8])
def test_run_memory(places, leaf_of, random):
    made = {name: lambda: ListEntry(9, PIXEL_BITS) for name in ("written", "shown")}
    ports = dict.fromkeys(("write_place", "read_place"), bits_for(places))
    leaf, held = leaf_of(run_memory, places=places, **ports, **made), {}
    for cycle in range(400):
        write = int(cycle < places or random.random() < 0.5)
        place = cycle if cycle < places else int(random.integers(places))
        read = int(random.choice([0, places - 1, random.integers(places)]))
        run = (int(random.integers(10)), int(random.integers(1 << PIXEL_BITS)))
        leaf.case({"write": write, "write_place": place, **entry("written", run), "read_place": read})
        if read in held and not (write and place == read):
            leaf.expected[cycle + 2] |= entry("shown", held[read])
        if write:
            held[place] = run
    leaf.expected.pop(leaf.cycle, None)
    leaf.expected.pop(leaf.cycle + 1, None)
    leaf.check(settled=places + 2)
    # Tools would take minutes for the initial values of a large list.
    assert "memory[i] =" not in leaf.modules[-1].path.read_text()
