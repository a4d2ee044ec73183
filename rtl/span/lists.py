# SPDX-License-Identifier: MIT
"""Entries of the lists that units draw and the monitor shows, and what becomes of frames."""

from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.rtl.common.widths import WORD_BITS


def end_bits(columns: int) -> int:
    """Width of the column after a run's last, 0 up to the number of columns."""
    return bits_for(columns + 1)


def entry_bits(entries: int) -> int:
    """Width of the number of an entry of either list, 0 up to one past the last of both."""
    return bits_for(2 * entries + 1)


class ListEntry(Record):
    """A run of columns of one colour, as it is kept in a list.

    end: the column after the run's last, 1 to the number of columns, which ends the row. pixel: its colour as the
    monitor gets it, red above green above blue.
    """

    def __init__(self, columns: int, pixel_bits: int):
        super().__init__({"end": end_bits(columns), "pixel": pixel_bits})


class FrameEvents(Interface):
    """Events in the life of a frame: strobes, except time.

    Attributes:
        drawn: a frame is whole.
        shown: a frame that has been drawn is handed over to the monitor.
        again: StartScreen, and the frame before stands, as no whole one follows it.
        late: StartScreen, and a frame is still being drawn.
        list_full: a frame is abandoned, as its list is full.
        time: with drawn, cycles of the frame since the StartScreen at which it began; with shown, cycles since it was
            whole. It saturates.
    """

    def __init__(self):
        self.drawn, self.shown, self.again, self.late, self.list_full = (bit() for _ in range(5))
        self.time = unsigned(WORD_BITS)
