# SPDX-License-Identifier: MIT
"""From the processor's bus to an Avalon-MM agent."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.rtl.common.widths import LANES, bit


@block
def avalon_host(clk, reset, access, strobe, address, data, avm_m0):
    """Avalon-MM host: each access of the processor is one transfer, of a word, and one read at a time is outstanding.

    access: Access; strobe, address, data: as `interfaces.ProcessorBus` has them, but address counts words; they hold
    still as long as access.select is high. The agent answers a read with readdatavalid in a later cycle than it took it
    in.
    """
    every_lane = (1 << LANES) - 1
    reading, writing, waiting = bit(), bit(), bit()

    @always_comb
    def decode():
        reading.next = access.select and (strobe == 0)
        writing.next = access.select and (strobe != 0)

    # A write is there until it is taken, and so is a read, which then only waits for its answer.
    @always_comb
    def request():
        avm_m0.read.next = reading and not waiting
        avm_m0.write.next = writing
        avm_m0.address.next = address
        avm_m0.writedata.next = data
        avm_m0.byteenable.next = every_lane
        if writing:
            avm_m0.byteenable.next = strobe

    # waiting: a read was taken and is not answered.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if waiting:
            waiting.next = not avm_m0.readdatavalid
        else:
            waiting.next = reading and not avm_m0.waitrequest

    # A write is done when it is taken, a read when it is answered.
    @always_comb
    def answer():
        access.ready.next = False
        if waiting:
            access.ready.next = avm_m0.readdatavalid
        elif writing:
            access.ready.next = not avm_m0.waitrequest
        access.word.next = avm_m0.readdata

    return instances()
