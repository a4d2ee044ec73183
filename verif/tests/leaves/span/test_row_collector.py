# SPDX-License-Identifier: MIT
"""`row_collector`: rows of any number of runs, lists exactly full and with a run too many, resets in the middle."""

from list_vectors import PIXEL_BITS, Collector, any_row, entry
from vectors import by

from raycaster.hdl.signals import bit, bits_for
from raycaster.rtl.span.lists import ListEntry, entry_bits
from raycaster.rtl.span.row_collector import row_collector

COLUMNS, ROWS, ENTRIES = 6, 3, 10


@by(units=[1, 2, 3], pause=[0.0, 0.5])
def test_row_collector(units, pause, leaf_of, random):
    width = entry_bits(ENTRIES)
    made = {name: lambda: ListEntry(COLUMNS, PIXEL_BITS) for name in ("head", "entry")}
    sizes = {"columns": COLUMNS, "rows": ROWS, "units": units, "entries": ENTRIES}
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
        leaf.stimulus[-1] |= entry("head", head or (int(random.integers(COLUMNS + 1)), 0))
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
            runs = [run for _ in range(ROWS + 1) for run in any_row(random, COLUMNS)]
        elif reset or full:
            runs = []
    leaf.check(settled=3)
    assert {ROWS, ENTRIES, "full"} <= ends
