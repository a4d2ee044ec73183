# SPDX-License-Identifier: MIT
"""Leaf test of `pair_player`: rows that begin with an even or an odd entry; pairs of one, two and parts of runs."""

from list_vectors import PIXEL_BITS, Beam, any_row, entry, list_screen, pixels_of
from vectors import by

from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.pair_player import pair_player


@by(columns=[2, 8])
def test_pair_player(columns, leaf_of, random):
    made = {name: lambda: ListEntry(columns, PIXEL_BITS) for name in ("head_0", "head_1")}
    leaf = leaf_of(pair_player, left=PIXEL_BITS, right=PIXEL_BITS, **made)
    beam, playing, row, pixels, place, both = Beam(list_screen(columns, 3, 1, 1), 2), 0, [], [], 0, 0
    for cycle in range(leaf.some(60) * beam.period // 6):
        scan = beam.scan()
        visible = scan["visible_line"]
        if not visible:
            row = any_row(random, columns)
            pixels, playing, place = pixels_of(row), int(random.random() < 0.8), int(random.integers(2))
        odd = place % 2
        # After the row's last run comes whatever the list holds.
        now, after = [*row, (int(random.integers(columns + 1)), 1), (int(random.integers(columns + 1)), 2)][:2]
        leaf.case({"playing": playing, "visible_line": visible, "next_column": scan["next_column"], "odd": odd})
        leaf.stimulus[-1] |= entry("head_0", after if odd else now) | entry("head_1", now if odd else after)
        takes = [False, False]
        if visible and playing:
            left, right = pixels[beam.column : beam.column + 2]
            count = sum(end <= beam.column + 2 for end, _ in row)
            takes = [count == 2 or (count == 1 and odd == bank) for bank in range(2)]
            row, place, both = row[count:], place + count, both + (count == 2)
        else:
            left = right = 0
        leaf.expected[cycle + 1] |= {"left": left, "right": right}
        leaf.expect({"take_0": takes[0], "take_1": takes[1]})
        beam.clock(reset=False)
    leaf.expected.pop(leaf.cycle)
    leaf.check(settled=1)
    assert both > 5
