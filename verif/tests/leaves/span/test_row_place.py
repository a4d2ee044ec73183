# SPDX-License-Identifier: MIT
"""Leaf test of `row_place`: rows of any length, in one line or in several; black frames; resets in the middle."""

from list_vectors import Beam, list_screen
from vectors import by, named

from raycaster.rtl.common.interfaces import Scan
from raycaster.rtl.span.row_place import row_place

BITS, COLUMNS = 5, 4


@by(pixels=[1, 2], clocks=[1, 2], doubling=[1, 3])
def test_row_place(pixels, doubling, clocks, leaf_of, random):
    leaf = leaf_of(row_place, scan=Scan, taken=2, place=BITS)
    beam, rows = Beam(list_screen(COLUMNS, 3, doubling, clocks), pixels), 0

    def line(begin: int, length: int):
        """Play a line of a row, whose runs may end anywhere, but the last with the line: yield what ends when."""
        for column in range(0, COLUMNS, pixels):
            later = COLUMNS - column - pixels
            most = length if not later else min(pixels, length - 1)
            taken = int(random.integers(max(0, length - later), most + 1))
            yield begin, taken
            begin, length = begin + taken, length - taken

    row = length = view_run = playing = visible = place = 0
    played, coming, leaving, restarts = iter(()), {}, set(), {}
    leaf.case({"reset": 1})
    for _ in range(leaf.some(60) * beam.period):
        cycle, scan = leaf.cycle, beam.scan()
        reset = int(random.random() < 0.03 / beam.period)
        if cycle in coming:
            row, length, playing = coming.pop(cycle)
            rows += playing
        if cycle in leaving:
            playing = 0
        if visible and not scan["visible_line"]:
            restarts[cycle + 1] = playing
        visible, taken = scan["visible_line"], 0
        if not visible:
            played = line(row, length) if playing else iter(())
        if playing and scan["next_column"]:
            place, taken = next(played)
        leaf.case({"reset": reset, **named("scan", scan), "view_run": view_run, "taken": taken})
        restart = restarts.pop(cycle, 0)
        leaf.expect({"playing": playing, "restart": restart})
        leaf.expect({"place": row % (1 << BITS)}, when=restart and not (coming or leaving))
        leaf.expect({"place": place % (1 << BITS)}, when=taken)
        beam.clock(bool(reset))
        # It changes in the cycle after StartScreen.
        if scan["start_screen"]:
            view_run = int(random.random() < 0.8)
            leaving.add(cycle + 2)
            row = length = 0
        if scan["start_row"]:
            coming[cycle + 2] = row + length, int(random.integers(1, COLUMNS + 1)), view_run
            restarts[cycle + 2] = view_run
        if reset:
            row = length = playing = visible = 0
            coming, leaving, restarts = {}, set(), {}
    leaf.check(settled=1, spare=True)
    assert rows > leaf.some(20)
