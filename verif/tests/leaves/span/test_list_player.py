# SPDX-License-Identifier: MIT
"""Leaf test of `list_player`: one list is shown, in lines of all lengths of runs, while the other one is written."""

from dataclasses import replace

import pytest
from list_vectors import PIXEL_BITS, Beam, any_frame, entry, list_screen, pixels_of, side_by_side
from vectors import by, named

from raycaster.rtl.common.interfaces import Scan, Vga
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.span.list_player import list_player
from raycaster.rtl.span.lists import ListEntry, entry_bits
from raycaster.rtl.video.video_generator import video_generator

COLUMNS, ROWS = 8, 4


@by(entries=[16, 20], bank=[2048, 8, 2], pixels=[1, 2], doubling=[1, 2], clocks=[1, 2])
def test_list_player(entries, bank, pixels, doubling, clocks, leaf_of, random):
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
