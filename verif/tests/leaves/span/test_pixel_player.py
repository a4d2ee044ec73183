# SPDX-License-Identifier: MIT
"""Leaf test of `pixel_player`: rows of few and many runs, on screens with repeated pixels or without."""

from list_vectors import PIXEL_BITS, Beam, any_row, entry, list_screen, pixels_of
from vectors import by

from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.pixel_player import pixel_player


@by(columns=[4, 7], doubling=[1, 2], clocks=[1, 2])
def test_pixel_player(columns, doubling, clocks, leaf_of, random):
    leaf = leaf_of(pixel_player, head=lambda: ListEntry(columns, PIXEL_BITS), pixel=PIXEL_BITS)
    beam, playing, row, pixels, reads = Beam(list_screen(columns, 3, doubling, clocks)), 0, [], [], 0
    for cycle in range(leaf.some(60) * beam.period // 6):
        scan = beam.scan()
        visible = scan["visible_line"]
        if not visible:
            row = any_row(random, columns)
            pixels, playing = pixels_of(row), int(random.random() < 0.8)
        leaf.case({"playing": playing, "visible_line": visible, "next_column": scan["next_column"]})
        leaf.stimulus[-1] |= entry("head", row[0] if row else (0, 0))
        take = False
        column = beam.column
        if visible and playing:
            leaf.expected[cycle + 1]["pixel"] = pixels[column]
            take = bool(scan["next_column"]) and row[0][0] == column + 1
        else:
            leaf.expected[cycle + 1]["pixel"] = 0
        leaf.expect({"take": take})
        reads += take
        row = row[take:]
        beam.clock(reset=False)
    leaf.expected.pop(leaf.cycle)
    leaf.check(settled=1)
    assert reads > leaf.some(20)
