# SPDX-License-Identifier: MIT
"""A bridge from AXI4-Lite to an Avalon-MM agent."""

from myhdl import always_comb, always_seq, block, instances

from raycaster.hdl.signals import bit, unsigned
from raycaster.hdl.verbs import assign
from raycaster.rtl.common.interfaces import BusPort
from raycaster.rtl.common.widths import LANES, WORD_BITS


class Axi4LitePort(BusPort):
    """A 32-bit AXI4-Lite port of a subordinate, without AWPROT and ARPROT, which no register needs.

    address_bits: width of a word address; awaddr and araddr are two bits wider, as they count bytes.

    Attributes:
        awaddr: byte offset of the register to write; the lowest two bits are ignored.
        awvalid: awaddr waits to be accepted.
        awready: awaddr is accepted at the end of this cycle.
        wdata: word to write.
        wstrb: one bit per byte of wdata; only bytes whose bit is 1 are written.
        wvalid: wdata and wstrb wait to be accepted.
        wready: wdata and wstrb are accepted at the end of this cycle.
        bresp: response to a write, always 0, which is OKAY.
        bvalid: a write is done, and its response waits to be accepted.
        bready: bresp is accepted at the end of this cycle.
        araddr: byte offset of the register to read; the lowest two bits are ignored.
        arvalid: araddr waits to be accepted.
        arready: araddr is accepted at the end of this cycle.
        rdata: word that was read.
        rresp: response to a read, always 0, which is OKAY.
        rvalid: rdata waits to be accepted.
        rready: rdata is accepted at the end of this cycle.
    """

    outputs = "awready", "wready", "bresp", "bvalid", "arready", "rdata", "rresp", "rvalid"

    def __init__(self, address_bits: int):
        self.awaddr, self.awvalid, self.awready = unsigned(address_bits + 2), bit(), bit()
        self.wdata, self.wstrb, self.wvalid, self.wready = unsigned(WORD_BITS), unsigned(LANES), bit(), bit()
        self.bresp, self.bvalid, self.bready = unsigned(2), bit(), bit()
        self.araddr, self.arvalid, self.arready = unsigned(address_bits + 2), bit(), bit()
        self.rdata, self.rresp, self.rvalid, self.rready = unsigned(WORD_BITS), unsigned(2), bit(), bit()


@block
def axi4lite_bridge(clk, reset, s_axi, avm_m0):
    """Bridge AXI4-Lite to an Avalon-MM agent: one write and one read at a time, in any order, answered with OKAY.

    A write is sent to the agent when its address and data are both valid, before a simultaneous read; its response
    comes two cycles later. A read's data comes with the agent's answer, two cycles after its address if the agent has
    that latency; a write may come in between. Each cycle of waitrequest adds one. No output of s_axi depends on an
    input of s_axi in the same cycle. The agent must answer after two cycles or more, hold readdata until its next
    answer, and ignore byteenable for reads, which is don't care there.

    Args:
        s_axi: `Axi4LitePort`, this block as the subordinate: drives awready, wready, bresp, bvalid, arready, rdata,
            rresp and rvalid, reads the rest.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
    """
    writing, write_taken, responding = bit(), bit(), bit()
    asking, read_taken, reading, read_waits, answered, answer_kept = (bit() for _ in range(6))

    # A write does not interrupt a read that waits for the agent to accept it.
    @always_comb
    def choose_write():
        writing.next = (
            s_axi.awvalid and s_axi.wvalid and not write_taken and not read_waits and (s_axi.bready or not responding)
        )

    choose_read = assign(asking, lambda: s_axi.arvalid and not writing and not reading and not answer_kept)
    request = assign((avm_m0.write, avm_m0.read), lambda: (writing, asking))
    pass_on = assign((avm_m0.writedata, avm_m0.byteenable), lambda: (s_axi.wdata, s_axi.wstrb))
    request_address = assign(avm_m0.address, lambda: s_axi.awaddr[:2] if writing else s_axi.araddr[:2])

    # Address and data are accepted in the cycle after the agent accepted them.
    @always_seq(clk.posedge, reset=reset)
    def follow_write():
        write_taken.next = writing and not avm_m0.waitrequest
        if write_taken:
            responding.next = True
        elif s_axi.bready:
            responding.next = False

    @always_seq(clk.posedge, reset=reset)
    def follow_read():
        read_taken.next = asking and not avm_m0.waitrequest
        read_waits.next = asking and avm_m0.waitrequest
        if asking and not avm_m0.waitrequest:
            reading.next = True
        elif avm_m0.readdatavalid:
            reading.next = False
        answer_kept.next = answered and not s_axi.rready

    find_answer = assign(answered, lambda: avm_m0.readdatavalid or answer_kept)
    answer_write = assign(
        (s_axi.awready, s_axi.wready, s_axi.bvalid, s_axi.bresp), lambda: (write_taken, write_taken, responding, 0)
    )
    answer_read = assign(
        (s_axi.arready, s_axi.rvalid, s_axi.rdata, s_axi.rresp), lambda: (read_taken, answered, avm_m0.readdata, 0)
    )

    return instances()
