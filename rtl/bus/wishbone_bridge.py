# SPDX-License-Identifier: MIT
"""A bridge from Wishbone to an Avalon-MM agent."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.interfaces import BusPort
from raycaster.rtl.common.widths import LANES, WORD_BITS


class WishbonePort(BusPort):
    """A Wishbone B4 port of a slave for classic cycles, 32 bits in lanes of 8; adr counts words.

    Attributes:
        cyc: high for the whole bus cycle.
        stb: request, held until ack.
        we: 1: write, 0: read.
        ack: the request is done in this cycle.
        adr: register number, the byte offset divided by four.
        sel: one bit per byte of dat_w; only bytes whose bit is 1 are written.
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
    """Bridge Wishbone B4 classic cycles to an Avalon-MM agent: each access becomes one transfer, acknowledged once.

    A write is acknowledged in the cycle in which the agent accepts it, its first cycle if waitrequest is low; a read
    when the agent answers, two cycles after its first cycle if the agent has that latency. A master may abandon a read:
    its answer is then not acknowledged, and the next access waits for it. The agent must ignore byteenable for reads.

    Args:
        wb: `WishbonePort`, this block as the slave: drives ack and dat_r, reads the rest.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
    """
    selected, reading, still_wanted = bit(), bit(), bit()

    select = assign(selected, lambda: wb.cyc and wb.stb)
    request_write = assign(avm_m0.write, lambda: selected and wb.we and not reading)
    request_read = assign(avm_m0.read, lambda: selected and not wb.we and not reading)
    pass_on = assign((avm_m0.address, avm_m0.writedata, avm_m0.byteenable), lambda: (wb.adr, wb.dat_w, wb.sel))

    # reading: a read was accepted and is not answered yet.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if reading:
            reading.next = not avm_m0.readdatavalid
        else:
            reading.next = selected and not wb.we and not avm_m0.waitrequest

    # still_wanted: the master has not abandoned the read; don't care unless reading.
    follow_master = register(clk, still_wanted, lambda: selected and (still_wanted or not reading))

    @always_comb
    def answer():
        wb.dat_r.next = avm_m0.readdata
        if reading:
            wb.ack.next = selected and still_wanted and avm_m0.readdatavalid
        else:
            wb.ack.next = selected and wb.we and not avm_m0.waitrequest

    return instances()
