# SPDX-License-Identifier: MIT
"""Entries of the lists that units draw and the monitor shows."""

from raycaster.hdl.records import Record
from raycaster.hdl.signals import bits_for


def end_bits(columns: int) -> int:
    """Width of the column after a run's last, 0 up to the number of columns."""
    return bits_for(columns + 1)


def entry_bits(entries: int) -> int:
    """Width of the number of an entry of a list, 0 up to one past the last."""
    return bits_for(entries + 1)


class ListEntry(Record):
    """A run of columns of one colour, as it is kept in a list.

    end: the column after the run's last, 1 to the number of columns, which ends the row. pixel: its colour as the
    monitor gets it, red above green above blue.
    """

    def __init__(self, columns: int, pixel_bits: int):
        super().__init__({"end": end_bits(columns), "pixel": pixel_bits})
