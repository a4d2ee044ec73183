# SPDX-License-Identifier: MIT
"""From the processor's bus to an Avalon-MM agent."""

from myhdl import always_comb, always_seq, block

from raycaster.rtl.common.widths import LANES, bit


@block
def avalon_host(
    clk,
    reset,
    select,
    strobe,
    address,
    data,
    ready,
    word,
    avm_m0_address,
    avm_m0_read,
    avm_m0_write,
    avm_m0_writedata,
    avm_m0_byteenable,
    avm_m0_readdata,
    avm_m0_readdatavalid,
    avm_m0_waitrequest,
):
    """Avalon-MM host: each access of the processor is one transfer, of a word, and one read at a time is outstanding.

    select: high from an access's first cycle to the one in which it is ready; strobe, address, data: as
    `interfaces.ProcessorBus` has them, but address counts words; they hold still as long as select is high. word: while
    ready. The agent answers a read with readdatavalid in a later cycle than it took it in.
    """
    every_lane = (1 << LANES) - 1
    reading, writing, waiting = bit(), bit(), bit()

    # What the processor asks for.
    @always_comb
    def decode():
        reading.next = select and (strobe == 0)
        writing.next = select and (strobe != 0)

    # A write is there until it is taken, and so is a read, which then only waits for its answer.
    @always_comb
    def request():
        avm_m0_read.next = reading and not waiting
        avm_m0_write.next = writing
        avm_m0_address.next = address
        avm_m0_writedata.next = data
        avm_m0_byteenable.next = every_lane
        if writing:
            avm_m0_byteenable.next = strobe

    # A read has been taken, and not been answered.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if waiting:
            waiting.next = not avm_m0_readdatavalid
        else:
            waiting.next = reading and not avm_m0_waitrequest

    # A write is done when it is taken, a read when it is answered.
    @always_comb
    def answer():
        ready.next = False
        if waiting:
            ready.next = avm_m0_readdatavalid
        elif writing:
            ready.next = not avm_m0_waitrequest
        word.next = avm_m0_readdata

    return decode, request, follow, answer
