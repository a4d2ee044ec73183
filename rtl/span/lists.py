# SPDX-License-Identifier: MIT
"""Entries of the lists that units draw and the monitor shows."""

from raycaster.hdl.records import Record
from raycaster.rtl.common.widths import end_bits


class ListEntry(Record):
    """A run of columns of one colour, as it is kept in a list.

    end: the column after the run's last, 1 to the number of columns, which ends the row. pixel: its colour as the
    monitor gets it, red above green above blue.
    """

    def __init__(self, columns: int, pixel_bits: int):
        super().__init__({"end": end_bits(columns), "pixel": pixel_bits})
