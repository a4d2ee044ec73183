# SPDX-License-Identifier: MIT
"""The place in the list of the line that the monitor shows."""

from myhdl import always_seq, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign


@block
def row_place(clk, reset, scan, view_run, taken, restart, place, playing):
    """Follow the shown list: each row begins where the row above ended, and each line of a row at the row's first run.

    After the last row its lines go on until StartScreen; they are in blanking. The comparisons that find the ends of
    runs take most of a cycle, so that they are counted in the cycle after.

    Args:
        scan: `Scan`; next_column is not read.
        view_run: flag; the list in view has a frame. Changes only in the cycle after scan.start_screen.
        taken: unsigned, 2 bits; entries that end in this cycle, 0 while the line is not visible.
        restart: output strobe, before each line of a row: in the second cycle after scan.start_row or after the end of
            a line's visible part.
        place: unsigned output; with restart, number of the line's first entry. In the line, number of the entry of the
            cycle before.
        playing: output flag; there is a row to show.
    """
    limit = 1 << len(place)

    was_visible, screen_starts, row_starts, line_ends = (bit() for _ in range(4))
    row_first, next_first, present = (unsigned(len(place)) for _ in range(3))
    taken_before = unsigned(len(taken))

    @always_seq(clk.posedge, reset=reset)
    def remember():
        was_visible.next, screen_starts.next = scan.visible_line, scan.start_screen
        row_starts.next, taken_before.next = scan.start_row, taken

    find_end = assign(line_ends, lambda: was_visible and not scan.visible_line)
    find_present = assign(present, lambda: (place + taken_before) % limit)

    # The end of a line comes before row_starts, if not in an earlier line.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        restart.next = False
        if screen_starts:
            playing.next = False
            next_first.next = 0
        elif row_starts:
            playing.next = restart.next = view_run
            row_first.next = place.next = next_first
        elif line_ends:
            restart.next, place.next = playing, row_first
            if playing:
                next_first.next = present
        else:
            place.next = present

    return instances()
