# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that show a list on a monitor."""

from dataclasses import replace

import pytest
from list_vectors import PIXEL_BITS, Beam, any_frame, any_row, entry, list_screen, pixels_of, side_by_side
from vectors import by, named

from raycaster.rtl.common.interfaces import Scan, Vga
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.common.widths import entry_bits
from raycaster.rtl.span.list_player import list_player
from raycaster.rtl.span.lists import ListEntry
from raycaster.rtl.span.pair_player import pair_player
from raycaster.rtl.span.pixel_player import pixel_player
from raycaster.rtl.span.row_place import row_place
from raycaster.rtl.video.video_generator import video_generator

PLACE_BITS, PLACE_COLUMNS = 5, 4


@by(pixels=[1, 2], clocks=[1, 2], doubling=[1, 3])
def test_row_place(pixels, doubling, clocks, leaf_of, random):
    """Rows of any length, in one line or in several; black frames; resets in the middle."""
    leaf = leaf_of(row_place, scan=Scan, taken=2, place=PLACE_BITS)
    beam, rows = Beam(list_screen(PLACE_COLUMNS, 3, doubling, clocks), pixels), 0

    def line(begin: int, length: int):
        """Play a line of a row, whose runs may end anywhere, but the last with the line: yield what ends when."""
        for column in range(0, PLACE_COLUMNS, pixels):
            later = PLACE_COLUMNS - column - pixels
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
        leaf.expect({"place": row % (1 << PLACE_BITS)}, when=restart and not (coming or leaving))
        if taken and not reset:
            leaf.expected[cycle + 1]["place"] = place % (1 << PLACE_BITS)
        beam.clock(bool(reset))
        # It changes in the cycle after StartScreen.
        if scan["start_screen"]:
            view_run = int(random.random() < 0.8)
            leaving.add(cycle + 2)
            row = length = 0
        if scan["start_row"]:
            coming[cycle + 2] = row + length, int(random.integers(1, PLACE_COLUMNS + 1)), view_run
            restarts[cycle + 2] = view_run
        if reset:
            row = length = playing = visible = 0
            coming, leaving, restarts = {}, set(), {}
    leaf.expected.pop(leaf.cycle, None)
    leaf.check(settled=1, spare=True)
    assert rows > leaf.some(20)


@by(columns=[4, 7], doubling=[1, 2], clocks=[1, 2])
def test_pixel_player(columns, doubling, clocks, leaf_of, random):
    """Rows of few and many runs, on screens with repeated pixels or without."""
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


@by(columns=[2, 8])
def test_pair_player(columns, leaf_of, random):
    """Rows that begin with an even or an odd entry; pairs of one, two and parts of runs."""
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


COLUMNS, ROWS = 8, 4


@by(entries=[16, 20], bank=[2048, 8, 2], pixels=[1, 2], doubling=[1, 2], clocks=[1, 2])
def test_list_player(entries, bank, pixels, doubling, clocks, leaf_of, random):
    """One list is shown, in lines of all lengths of runs, while the other one is written."""
    made = {"written": lambda: ListEntry(COLUMNS, PIXEL_BITS), "scan": Scan}
    ports = {"write_place": entry_bits(entries), "shown": pixels * PIXEL_BITS}
    leaf = leaf_of(list_player, entries=entries, pixels=pixels, bank=bank, **ports, **made)
    beam, upper, view_run, full = Beam(list_screen(COLUMNS, ROWS, doubling, clocks), pixels), 0, 0, 0
    # The rows of each list, and what is still to be written of the one that is drawn.
    frames, runs, place = [None, None], [], 0
    leaf.case({"reset": 1})
    for _ in range(leaf.some(15) * beam.period):
        cycle, scan = leaf.cycle, beam.scan()
        write = bool(runs) and random.random() < 0.5
        leaf.case({"reset": 0, **named("scan", scan), "upper": upper, "view_run": view_run, "write": write})
        leaf.stimulus[-1] |= {"write_place": place} | entry("written", runs[0] if runs else (0, 0))
        if beam.place:
            row, column = beam.place
            view = frames[1 - upper]
            pixels_shown = pixels_of(view[row])[column : column + pixels] if view_run else [0] * pixels
            leaf.expected[cycle + 1]["shown"] = side_by_side(pixels_shown, PIXEL_BITS)
        if write:
            runs, place = runs[1:], place + 1
            full += place == entries
        if scan["start_screen"]:
            if not runs and random.random() < 0.8:
                upper, view_run = 1 - upper, int(frames[upper] is not None and random.random() < 0.9)
            if not runs:
                rows = any_frame(random, COLUMNS, ROWS, entries)
                runs, place = [run for row in rows for run in row], 0
                frames[upper] = rows if len(runs) <= entries else None
                runs = runs if frames[upper] else []
        beam.clock(reset=False)
    leaf.expected.pop(leaf.cycle, None)
    leaf.check(settled=1)
    assert full > 0


@pytest.mark.parametrize(("pixels", "doubling", "clocks"), [(1, 1, 1), (1, 2, 1), (1, 1, 2), (1, 3, 2), (2, 1, 1)])
def test_the_monitor_of_these_tests(pixels, doubling, clocks, leaf_of):
    """The monitor of these tests has the strobes of `video_generator`."""
    screen = list_screen(COLUMNS, ROWS, doubling, clocks)
    beam, line = Beam(screen, pixels), screen.horizontal
    parts = {name: pixels * getattr(line, name) for name in ("front", "sync", "back")}
    paired = replace(screen, horizontal=replace(line, **parts), pixels_per_clock=pixels)
    ports = {"scan": Scan, "pixel": lambda: Pixel(8 * pixels), "vga": lambda: Vga(8 * pixels)}
    leaf = leaf_of(video_generator, screen=paired, lead=beam.lead, **ports)
    leaf.case({"reset": 1})
    for _ in range(2 * beam.period):
        leaf.case({"reset": 0}, named("scan", beam.scan()))
        beam.clock(reset=False)
    leaf.check(settled=1)
