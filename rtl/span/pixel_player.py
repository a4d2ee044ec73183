# SPDX-License-Identifier: MIT
"""From the runs of a row to its pixels, one per clock."""

from myhdl import always, block, instances

from raycaster.hdl.signals import unsigned
from raycaster.hdl.verbs import assign


@block
def pixel_player(clk, playing, visible_line, next_column, head, take, pixel):
    """Show the runs of a line, one after the other.

    Args:
        playing: flag; there is a row to show.
        visible_line: flag, as in `Scan`.
        next_column: strobe, as in `Scan`.
        head: `ListEntry`; the run of the present column.
        take: output strobe; the run's last column ends, and the next run must be at head in the next cycle.
        pixel: unsigned output, a pixel: that of the present column, a cycle later. 0 outside the line.
    """
    column_end = unsigned(len(head.end))

    @always(clk.posedge)
    def count():
        if not visible_line:
            column_end.next = 1
        elif next_column:
            column_end.next = (column_end + 1) % (1 << len(column_end))

    finish = assign(take, lambda: playing and next_column and (head.end == column_end))

    @always(clk.posedge)
    def show():
        pixel.next = 0
        if playing and visible_line:
            pixel.next = head.pixel

    return instances()
