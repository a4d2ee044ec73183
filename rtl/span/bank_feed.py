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
        write_banks: unsigned, a bit for each bank, of which one is set; read with write, like the two below.
        write_place: unsigned, a place of a bank.
        written: unsigned, the run.
        read: strobe; one of these banks reads.
        read_banks: unsigned, as write_banks; read with the strobe of that name, like the one below.
        read_place: unsigned, a place of a bank.
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
            near_writes.next = write_banks
            near_write_place.next = write_place
            near_written.next = written

    @always(clk.posedge)
    def pass_reads():
        near_reads.next = 0
        if read:
            near_reads.next = read_banks
            near_read_place.next = read_place

    return instances()
