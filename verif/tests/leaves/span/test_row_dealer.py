# SPDX-License-Identifier: MIT
"""`row_dealer`: units that are busy, idle or without room for any time; frames that are dropped in the middle."""

from list_vectors import Dealer
from vectors import by

from raycaster.hdl.signals import unsigned
from raycaster.rtl.span.row_dealer import row_dealer


@by(rows=[1, 13], units=[1, 2, 3, 5])
def test_row_dealer(rows, units, leaf_of, random):
    ports = {"room": units, "done": units, "start": lambda: unsigned(units)}
    leaf, model = leaf_of(row_dealer, rows=rows, units=units, **ports), Dealer(rows, units)
    leaf.case({"reset": 1})
    finished = at_once = 0
    for _ in range(3000):
        reset = int(random.random() < 0.01)
        idle = model.row == rows or not (model.dealing or model.settles or model.first_row)
        new_frame = int(idle and not model.busy and random.random() < 0.3)
        done = {unit for unit in model.busy if random.random() < 0.3}
        room = [random.random() < 0.8 for _ in range(units)]
        start = model.start(room, done)
        inputs = {"room": sum(flag << unit for unit, flag in enumerate(room)), "done": sum(1 << unit for unit in done)}
        leaf.case({"reset": reset, "new_frame": new_frame, **inputs})
        started = 0 if start is None else 1 << start
        leaf.expect({"first_row": model.first_row, "next_row": start is not None, "start": started})
        at_once += start in done
        model.clock(bool(new_frame), start, done, bool(reset))
        finished += start is not None and model.row == rows
    leaf.check(settled=1)
    assert finished > 20
    assert at_once > 20 or rows == 1 or units > 2
