# SPDX-License-Identifier: MIT
"""A block RAM with runs."""

from myhdl import always, block, instances

from raycaster.hdl.signals import Unset, unsigned


@block
def run_memory(clk, write, write_place, written, read_place, shown, places: int):
    """Keep runs in a block RAM, which is unknown at power-up, and whose output has a register.

    Args:
        clk: the clock.
        write: strobe; stores written.
        write_place: unsigned, below places; read with write.
        written: `ListEntry`; read with write.
        read_place: unsigned, below places.
        shown: `ListEntry`; output, the run at read_place two cycles later. Don't care if the place was written in the
            cycle in which it was read.
        places: number of runs.
    """
    memory = Unset(places, len(written.word))
    fetched = unsigned(len(written.word))

    @always(clk.posedge)
    def store():
        if write:
            memory[write_place].next = written.word

    @always(clk.posedge)
    def fetch():
        fetched.next = memory[read_place]

    @always(clk.posedge)
    def show():
        shown.word.next = fetched

    return instances()
