# SPDX-License-Identifier: MIT
"""A bridge from the processor's bus to an Avalon-MM agent."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.hdl.signals import bit
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.widths import LANES


@block
def avalon_host(clk, reset, access, strobe, address, data, avm_m0):
    """Pass the processor's accesses to an Avalon-MM agent, each as one transfer of a word.

    At most one read is outstanding. The agent answers a read with readdatavalid in a later cycle than the one in which
    it accepts it.

    Args:
        access: `Access`; reads select, drives ready and word.
        strobe: unsigned, 4 bits; the bytes of data to write, or 0 for a read. Stable while access.select is high.
        address: unsigned, as wide as avm_m0.address; word address. Stable while access.select is high.
        data: unsigned, 32 bits; the word to write. Stable while access.select is high.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
    """
    every_lane = (1 << LANES) - 1
    reading, writing, waiting = bit(), bit(), bit()

    decode = assign((reading, writing), lambda: (access.select and (strobe == 0), access.select and (strobe != 0)))

    # A write or read is requested until it is accepted; a read then waits for its answer.
    request = assign((avm_m0.read, avm_m0.write), lambda: (reading and not waiting, writing))
    pass_on = assign((avm_m0.address, avm_m0.writedata), lambda: (address, data))
    request_byteenable = assign(avm_m0.byteenable, lambda: strobe if writing else every_lane)

    # waiting: a read was accepted and is not answered yet.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if waiting:
            waiting.next = not avm_m0.readdatavalid
        else:
            waiting.next = reading and not avm_m0.waitrequest

    # A write is done when it is accepted, a read when it is answered.
    @always_comb
    def answer():
        access.ready.next = False
        if waiting:
            access.ready.next = avm_m0.readdatavalid
        elif writing:
            access.ready.next = not avm_m0.waitrequest
        access.word.next = avm_m0.readdata

    return instances()
