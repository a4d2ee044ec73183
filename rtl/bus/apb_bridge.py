# SPDX-License-Identifier: MIT
"""A bridge from APB to an Avalon-MM agent."""

from myhdl import always_seq, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import BusPort
from raycaster.rtl.common.widths import LANES, WORD_BITS


class ApbPort(BusPort):
    """A 32-bit APB4 port of a completer, without PPROT, which no register needs.

    address_bits: width of a word address; paddr is two bits wider, as it counts bytes.

    Attributes:
        paddr: byte offset of the register; the lowest two bits are ignored.
        psel: selects this block for a transfer, from its setup cycle to pready.
        penable: high in all cycles of a transfer after the first.
        pwrite: 1: write, 0: read.
        pready: the transfer is done in this cycle.
        pslverr: always 0.
        pwdata: word to write.
        pstrb: one bit per byte of pwdata; only bytes whose bit is 1 are written.
        prdata: word that was read, valid with pready.
    """

    outputs = "pready", "pslverr", "prdata"

    def __init__(self, address_bits: int):
        self.paddr = unsigned(address_bits + 2)
        self.psel, self.penable, self.pwrite, self.pready, self.pslverr = (bit() for _ in range(5))
        self.pwdata, self.pstrb, self.prdata = unsigned(WORD_BITS), unsigned(LANES), unsigned(WORD_BITS)


@block
def apb_bridge(clk, reset, s_apb, avm_m0):
    """Bridge APB4 to an Avalon-MM agent: each access becomes one transfer, and none is an error.

    A write is sent to the agent in its access phase, and completes when the agent accepts it: without a wait state if
    waitrequest is low. A read is sent in its setup phase, and completes when the agent answers: with one wait state if
    the agent takes two cycles. The agent must ignore byteenable for reads.

    Args:
        s_apb: `ApbPort`, this block as the completer: drives pready, prdata and pslverr, reads the rest.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
    """
    reading = bit()

    request_write = assign(avm_m0.write, lambda: s_apb.psel and s_apb.penable and s_apb.pwrite)
    request_read = assign(avm_m0.read, lambda: s_apb.psel and not s_apb.pwrite and not reading)
    request_address = assign(avm_m0.address, lambda: s_apb.paddr[:2])
    pass_on = assign((avm_m0.writedata, avm_m0.byteenable), lambda: (s_apb.pwdata, s_apb.pstrb))

    # reading: a read was accepted and is not answered yet.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if reading:
            reading.next = not avm_m0.readdatavalid
        else:
            reading.next = s_apb.psel and not s_apb.pwrite and not avm_m0.waitrequest

    see_ready = assign(
        s_apb.pready, lambda: avm_m0.readdatavalid if reading else s_apb.pwrite and not avm_m0.waitrequest
    )
    answer = assign((s_apb.prdata, s_apb.pslverr), lambda: (avm_m0.readdata, False))

    return instances()
