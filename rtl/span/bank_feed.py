# SPDX-License-Identifier: MIT
"""A stage between the ports of a memory for runs and some of its banks."""

from myhdl import always, block, instances


@block
def bank_feed(
    clk, write, write_banks, write_place, written, read, read_banks, read_place, near_writes, near_write_place,
    near_written, near_reads, near_read_place,
):  # fmt: skip
    """Register what up to four banks write and read, so that no wire goes to all banks of a large memory.

    Places and runs that are for none of them are not taken. So the registers of different banks differ, and synthesis
    keeps them apart.

    Args:
        write: strobe; one of these banks stores written.
        write_banks: unsigned, a bit for each bank; one is set. Read with write.
        write_place: unsigned, a place of a bank. Read with write.
        written: unsigned, the run. Read with write.
        read: strobe; one of these banks reads.
        read_banks: unsigned, a bit for each bank; one is set. Valid with the strobe read.
        read_place: unsigned, a place of a bank. Valid with the strobe read.
        near_writes: unsigned output, a bit for each bank; strobe, in the next cycle.
        near_write_place: unsigned output; valid with near_writes.
        near_written: unsigned output; valid with near_writes.
        near_reads: unsigned output, a bit for each bank; strobe, in the next cycle.
        near_read_place: unsigned output; valid with near_reads.
    """

    @always(clk.posedge)
    def pass_writes():
        near_writes.next = 0
        if write:
            near_writes.next, near_write_place.next, near_written.next = write_banks, write_place, written

    @always(clk.posedge)
    def pass_reads():
        near_reads.next = 0
        if read:
            near_reads.next, near_read_place.next = read_banks, read_place

    return instances()
