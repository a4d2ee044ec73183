# SPDX-License-Identifier: MIT
"""A bank of a memory for runs: block RAM with a register at its output."""

from myhdl import always, block, instances

from raycaster.hdl.signals import Unset, bit, unsigned
from raycaster.hdl.verbs import register


@block
def run_bank(clk, write, write_place, written, read, read_place, shown, places: int):
    """Keep runs in a block RAM, which is unknown at power-up.

    Args:
        write: strobe; stores written.
        write_place: unsigned, below places; read with write.
        written: unsigned; read with write.
        read: strobe.
        read_place: unsigned, below places; read with the strobe of that name.
        shown: unsigned output; two cycles after read the run at read_place, and 0 two cycles after there was no read.
            Don't care if the place was written in the cycle in which it was read.
        places: number of runs.
    """
    memory = Unset(places, len(written))
    fetched, reads = unsigned(len(written)), bit()

    store = register(clk, memory[write_place], lambda: written, write)

    @always(clk.posedge)
    def fetch():
        reads.next = read
        if read:
            fetched.next = memory[read_place]

    @always(clk.posedge)
    def show():
        shown.next = 0
        if reads:
            shown.next = fetched

    return instances()
