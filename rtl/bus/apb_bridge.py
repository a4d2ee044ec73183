# SPDX-License-Identifier: MIT
"""From APB to an Avalon-MM agent."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.rtl.common.interfaces import BusPort
from raycaster.rtl.common.widths import LANES, WORD_BITS, bit, unsigned


class ApbPort(BusPort):
    """APB4, 32 bits, as a completer has it; without protection types, to which no register pays regard.

    address_bits: of a word's address; paddr has two more, as it counts bytes.

    Attributes:
        paddr: byte offset of the register; the lowest two bits are not read.
        psel: a transfer to this block, from its setup cycle to pready.
        penable: high in all cycles of a transfer after the first.
        pwrite: 1: write, 0: read.
        pready: the transfer is done in this cycle.
        pslverr: always 0.
        pwdata: word to write.
        pstrb: a bit for each byte of pwdata; only bytes whose bit is 1 are written.
        prdata: word that was read, valid with pready.
    """

    outputs = "pready", "pslverr", "prdata"

    def __init__(self, address_bits: int):
        self.paddr = unsigned(address_bits + 2)
        self.psel, self.penable, self.pwrite, self.pready, self.pslverr = (bit() for _ in range(5))
        self.pwdata, self.pstrb, self.prdata = unsigned(WORD_BITS), unsigned(LANES), unsigned(WORD_BITS)


@block
def apb_bridge(clk, reset, s_apb, avm_m0):
    """Bridge APB4 to an Avalon-MM agent: each access is one transfer, and never an error.

    A write goes to the agent in its access phase, and is ready when the agent takes it: without a wait state where
    waitrequest is low. A read goes there in its setup phase already, and is ready when the agent answers it: one wait
    state with an agent that takes two cycles. The agent ignores byteenable for reads.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        s_apb: `ApbPort`, this block as the completer: drives pready, prdata and pslverr, reads the rest.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
    """
    reading = bit()

    @always_comb
    def request():
        avm_m0.write.next = s_apb.psel and s_apb.penable and s_apb.pwrite
        avm_m0.read.next = s_apb.psel and not s_apb.pwrite and not reading
        avm_m0.address.next = s_apb.paddr[:2]
        avm_m0.writedata.next = s_apb.pwdata
        avm_m0.byteenable.next = s_apb.pstrb

    # reading: a read was taken and is not answered.
    @always_seq(clk.posedge, reset=reset)
    def follow():
        if reading:
            reading.next = not avm_m0.readdatavalid
        else:
            reading.next = s_apb.psel and not s_apb.pwrite and not avm_m0.waitrequest

    @always_comb
    def answer():
        s_apb.pready.next = s_apb.pwrite and not avm_m0.waitrequest
        if reading:
            s_apb.pready.next = avm_m0.readdatavalid
        s_apb.prdata.next = avm_m0.readdata
        s_apb.pslverr.next = False

    return instances()
