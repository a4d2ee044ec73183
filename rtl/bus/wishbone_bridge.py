# SPDX-License-Identifier: MIT
"""From Wishbone to an Avalon-MM agent."""

from myhdl import always, always_comb, always_seq, block, instances

from raycaster.rtl.common.interfaces import BusPort
from raycaster.rtl.common.widths import LANES, WORD_BITS, bit, unsigned


class WishbonePort(BusPort):
    """Wishbone B4, classic cycles, 32 bits in lanes of 8, as a slave has it; adr counts words.

    Attributes:
        cyc: high for the whole bus cycle.
        stb: request, held until ack.
        we: 1: write, 0: read.
        ack: the request is done in this cycle.
        adr: number of the register, its byte offset over four.
        sel: a bit for each byte of dat_w; only bytes whose bit is 1 are written.
        dat_w: word to write.
        dat_r: word that was read, valid with ack.
    """

    outputs = "ack", "dat_r"

    def __init__(self, address_bits: int):
        self.cyc, self.stb, self.we, self.ack = (bit() for _ in range(4))
        self.adr, self.sel = unsigned(address_bits), unsigned(LANES)
        self.dat_w, self.dat_r = unsigned(WORD_BITS), unsigned(WORD_BITS)


@block
def wishbone_bridge(clk, reset, wb, avm_m0):
    """Bridge Wishbone B4 classic cycles to an Avalon-MM agent: each access is one transfer, and acknowledged once.

    A write is acknowledged in the cycle in which the agent takes it, its first where waitrequest is low; a read when
    the agent answers it, two cycles after its first with an agent of that latency. Only an access that is there is
    acknowledged, so a master may give up a read: its answer goes to nobody, and the next access waits for it. The agent
    ignores byteenable for reads.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        wb: `WishbonePort`, this block as the slave: drives ack and dat_r, reads the rest.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
    """
    selected, reading, still_wanted = bit(), bit(), bit()

    @always_comb
    def select():
        selected.next = wb.cyc and wb.stb

    @always_comb
    def request():
        avm_m0.write.next = selected and wb.we and not reading
        avm_m0.read.next = selected and not wb.we and not reading
        avm_m0.address.next = wb.adr
        avm_m0.writedata.next = wb.dat_w
        avm_m0.byteenable.next = wb.sel

    # reading: a read was taken and is not answered.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if reading:
            reading.next = not avm_m0.readdatavalid
        else:
            reading.next = selected and not wb.we and not avm_m0.waitrequest

    # The access that the read was for has not ended; don't care unless reading.
    @always(clk.posedge)
    def follow_master():
        still_wanted.next = selected and (still_wanted or not reading)

    @always_comb
    def answer():
        wb.dat_r.next = avm_m0.readdata
        if reading:
            wb.ack.next = selected and still_wanted and avm_m0.readdatavalid
        else:
            wb.ack.next = selected and wb.we and not avm_m0.waitrequest

    return instances()
