# SPDX-License-Identifier: MIT
"""From the runs of a row to its pixels, two per clock."""

from myhdl import always, always_comb, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign


@block
def pair_player(clk, playing, visible_line, next_column, odd, head_0, head_1, take_0, take_1, left, right):
    """Show the runs of a line, which come in turn from the even and from the odd entries of the list.

    Args:
        playing: flag; there is a row to show.
        visible_line: flag, as in `Scan`.
        next_column: strobe, as in `Scan`, for each pair of columns; the left one is even.
        odd: flag; the present run is an odd entry.
        head_0: `ListEntry`; if odd is low the run of the present left column, else the one after it.
        head_1: `ListEntry`; likewise, the other way round.
        take_0: output strobe; the run at head_0 ends in this pair, and the next even entry must be there in the next
            cycle.
        take_1: output strobe; likewise for head_1.
        left: unsigned output, a pixel: that of the present left column, a cycle later. 0 outside the line.
        right: unsigned output; likewise for the right column.
    """
    span = 1 << len(head_0.end)

    column_end, end_of_pair = unsigned(len(head_0.end)), unsigned(len(head_0.end))
    now, after = head_0.twin(), head_0.twin()
    splits, now_ends, after_ends, take_now, take_after = (bit() for _ in range(5))

    @always(clk.posedge)
    def count():
        if not visible_line:
            column_end.next = 1
            end_of_pair.next = 2
        elif next_column:
            column_end.next = (column_end + 2) % span
            end_of_pair.next = (end_of_pair + 2) % span

    order_now = assign(now.word, lambda: head_1.word if odd else head_0.word)
    order_after = assign(after.word, lambda: head_0.word if odd else head_1.word)

    @always_comb
    def compare():
        splits.next = now.end == column_end
        now_ends.next = now.end == end_of_pair
        after_ends.next = after.end == end_of_pair

    @always_comb
    def finish():
        take_now.next = playing and next_column and (splits or now_ends)
        take_after.next = playing and next_column and splits and after_ends

    pass_take_0 = assign(take_0, lambda: take_after if odd else take_now)
    pass_take_1 = assign(take_1, lambda: take_now if odd else take_after)

    @always(clk.posedge)
    def show():
        left.next = right.next = 0
        if playing and visible_line:
            left.next = right.next = now.pixel
            if splits:
                right.next = after.pixel

    return instances()
