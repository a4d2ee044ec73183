# SPDX-License-Identifier: MIT
"""Leaf tests of the bridges between buses, and of the host: every access is one transfer, for any agent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from vectors import EVERY_LANE, any_strobe, any_word, named

from raycaster.buses import BUSES
from raycaster.rtl.bus.apb_bridge import apb_bridge
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.bus.axi4lite_bridge import axi4lite_bridge
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.bus.wishbone_bridge import wishbone_bridge
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import LANES

ADDRESS_BITS = 6

CYCLES = 1500

agents = pytest.mark.parametrize(("patience", "latency"), [(0.0, 2), (0.3, 4), (0.8, 7)])
"""The agent's chance of a wait state, and the most cycles that it takes to answer."""


class Agent:
    """An Avalon-MM agent that inserts wait states and answers at random times."""

    def __init__(self, random: np.random.Generator, patience: float, latency: int):
        self._random, self._patience, self._latency = random, patience, latency
        self.reset()

    def reset(self) -> None:
        self._due = None  # cycles until the accepted read is answered
        self.word = self.waits = self.answers = 0
        self.taken = self.outstanding = False

    def drive(self) -> dict[str, int]:
        """Return the agent's outputs in this cycle; readdata changes only with an answer."""
        self.answers = int(self._due == 0)
        self._due = None if self._due in (None, 0) else self._due - 1
        self.waits = int(self._random.random() < self._patience)
        if self.answers:
            self.word = any_word(self._random)
        return {"avm_m0_readdata": self.word, "avm_m0_readdatavalid": self.answers, "avm_m0_waitrequest": self.waits}

    def clock(self, reads: bool) -> None:
        """End a cycle in which a read is requested or not; its answer comes two cycles later at the earliest."""
        self.taken = reads and not self.waits
        self.outstanding = self.taken or (self.outstanding and not self.answers)
        if self.taken:
            self._due = int(self._random.integers(1, self._latency))


def any_lanes(random: np.random.Generator) -> int:
    return int(random.integers(1 << LANES))


def any_byte_address(random: np.random.Generator) -> int:
    """Return the address of any byte; it selects the word that the byte is in."""
    return int(random.integers(4 << ADDRESS_BITS))


def bridge_ports(name: str) -> dict[str, Callable]:
    """Return the two ports of a bus's bridge, as for `Bench`."""
    return {
        BUSES[name].port: lambda: BRIDGES[name].interface(ADDRESS_BITS),
        "avm_m0": lambda: AvalonPort(ADDRESS_BITS),
    }


@pytest.mark.parametrize(("patience", "latency"), [(0.0, 1), (0.3, 4), (0.8, 9)])
def test_avalon_host(patience, latency, leaf_of, random):
    """Every access is one transfer, for any waitrequest and any latency of the agent."""
    leaf = leaf_of(avalon_host, address=ADDRESS_BITS, avm_m0=lambda: AvalonPort(ADDRESS_BITS))
    leaf.case({"reset": 1})
    request = None  # strobe, address, data
    answer_in = None  # cycles until the accepted read is answered
    for _ in range(1000):
        if request is None and random.random() < 0.7:
            request = any_strobe(random), int(random.integers(1 << ADDRESS_BITS)), any_word(random)
        strobe, address, data = request or (any_strobe(random), 0, 0)
        wait, word = int(random.random() < patience), any_word(random)
        answered = answer_in == 0
        reading, writing = request is not None and strobe == 0, request is not None and strobe != 0
        agent = {"readdata": word, "readdatavalid": answered, "waitrequest": wait}
        access = {"access_select": request is not None, "strobe": strobe, "address": address, "data": data}
        leaf.case({"reset": 0, **access, **named("avm_m0", agent)})
        read = reading and answer_in is None
        ready = answered or (writing and not wait)
        leaf.expect({"access_ready": ready, "avm_m0_read": read, "avm_m0_write": writing})
        leaf.expect({"access_word": word}, when=answered)
        leaf.expect({"avm_m0_address": address, "avm_m0_byteenable": strobe or EVERY_LANE}, when=read or writing)
        leaf.expect({"avm_m0_writedata": data}, when=writing)
        if ready:
            request = answer_in = None
        elif answer_in is not None:
            answer_in -= 1
        elif read and not wait:
            answer_in = int(random.integers(latency))
    leaf.check(settled=1)


@agents
def test_apb_bridge(patience, latency, leaf_of, random):
    """Writes are accepted in their access phase, reads begin in their setup phase; some are back to back."""
    leaf, agent = leaf_of(apb_bridge, **bridge_ports("apb")), Agent(random, patience, latency)
    leaf.case({"reset": 1})
    access = None  # write, address, lanes, word
    enable, done = False, 0
    for _ in range(CYCLES):
        reset = int(random.random() < 0.02)
        if reset:
            access, enable = None, False
        elif access is None and random.random() < 0.7:
            access = int(random.random() < 0.5), any_byte_address(random), any_lanes(random), any_word(random)
        write, address, lanes, word = access or (int(random.integers(2)), 0, 0, any_word(random))
        phases = {"s_apb_psel": access is not None, "s_apb_penable": enable if access else random.integers(2)}
        asked = {"s_apb_pwrite": write, "s_apb_paddr": address, "s_apb_pwdata": word, "s_apb_pstrb": lanes}
        leaf.case({"reset": reset, **phases, **asked, **agent.drive()})
        writes = access is not None and write and enable
        reads = access is not None and not write and not agent.outstanding
        ready = (writes and not agent.waits) or (agent.outstanding and agent.answers)
        leaf.expect({"avm_m0_write": writes, "avm_m0_read": reads, "s_apb_pslverr": 0})
        leaf.expect({"s_apb_pready": ready}, when=enable)
        leaf.expect({"avm_m0_address": address // 4}, when=writes or reads)
        leaf.expect({"avm_m0_writedata": word, "avm_m0_byteenable": lanes}, when=writes)
        leaf.expect({"s_apb_prdata": agent.word}, when=ready and not write)
        agent.clock(reads)
        enable = access is not None and not ready
        if ready:
            access, done = None, done + 1
        if reset:
            agent.reset()
    leaf.check(settled=1)
    assert done > CYCLES // 20


@agents
@pytest.mark.parametrize("pause", [0.0, 0.5])
def test_axi4lite_bridge(patience, latency, pause, leaf_of, random):
    """Channels become valid in any order and at any distance; responses are accepted at any time."""
    leaf, agent = leaf_of(axi4lite_bridge, **bridge_ports("axi4lite")), Agent(random, patience, latency)
    leaf.case({"reset": 1})
    written, read = 0, 0
    address = word = asked = None  # what is valid on the manager's three channels
    taken_write = response = answer = read_waits = False
    for _ in range(CYCLES):
        reset = int(random.random() < 0.02)
        if reset:
            address = word = asked = None
        else:
            address = any_byte_address(random) if address is None and random.random() >= pause else address
            word = (any_word(random), any_lanes(random)) if word is None and random.random() >= pause else word
            asked = any_byte_address(random) if asked is None and random.random() >= pause else asked
        bready, rready = (int(random.random() >= pause) for _ in range(2))
        manager = {"awvalid": address is not None, "wvalid": word is not None, "arvalid": asked is not None}
        manager |= {"bready": bready, "rready": rready}
        manager["awaddr"] = any_byte_address(random) if address is None else address
        manager["wdata"] = word[0] if word else any_word(random)
        manager["wstrb"] = word[1] if word else any_lanes(random)
        manager["araddr"] = any_byte_address(random) if asked is None else asked
        leaf.case({"reset": reset, **named("s_axi", manager), **agent.drive()})
        answer = answer or agent.answers
        write = address is not None and word is not None and not taken_write and not read_waits
        write = write and not (response and not bready)
        reads = asked is not None and not write and not agent.taken and not agent.outstanding and not answer
        ready = {"awready": taken_write, "wready": taken_write, "arready": agent.taken}
        leaf.expect({"avm_m0_write": write, "avm_m0_read": reads, **named("s_axi", ready)})
        leaf.expect({"s_axi_bvalid": response, "s_axi_bresp": 0, "s_axi_rvalid": answer, "s_axi_rresp": 0})
        if write:
            leaf.expect({"avm_m0_address": address // 4, "avm_m0_writedata": word[0], "avm_m0_byteenable": word[1]})
        if reads:
            leaf.expect({"avm_m0_address": asked // 4})
        leaf.expect({"s_axi_rdata": agent.word}, when=answer)
        written, read = written + (response and bready), read + (answer and rready)
        response = taken_write or (response and not bready)
        if taken_write:
            address = word = None
        if agent.taken:
            asked = None
        taken_write, read_waits = write and not agent.waits, reads and agent.waits
        agent.clock(reads)
        answer = answer and not rready
        if reset:
            taken_write = response = answer = read_waits = False
            agent.reset()
    leaf.check(settled=1)
    assert min(written, read) > CYCLES // 40


@agents
def test_wishbone_bridge(patience, latency, leaf_of, random):
    """A master waits for its answer or gives up; a later access never gets that answer."""
    leaf, agent = leaf_of(wishbone_bridge, **bridge_ports("wishbone")), Agent(random, patience, latency)
    leaf.case({"reset": 1})
    access = None  # write, address, lanes, word
    done, given_up, stale = 0, 0, False
    for _ in range(CYCLES):
        reset = int(random.random() < 0.02)
        if access is not None and random.random() < 0.05:
            access, given_up = None, given_up + 1
        elif access is None and random.random() < 0.7:
            write, address = int(random.random() < 0.5), int(random.integers(1 << ADDRESS_BITS))
            access = write, address, any_lanes(random), any_word(random)
        write, address, lanes, word = access or (int(random.integers(2)), 0, 0, any_word(random))
        half = int(random.integers(3))  # only cyc and stb together are an access
        stale = stale or access is None
        master = {"cyc": access is not None or half == 1, "stb": access is not None or half == 2}
        master |= {"we": write, "adr": address, "sel": lanes, "dat_w": word}
        leaf.case({"reset": reset, **named("wb", master), **agent.drive()})
        asks = access is not None and not agent.outstanding
        reads, writes = asks and not write, asks and write
        own_answer = agent.outstanding and not stale and agent.answers
        acknowledged = own_answer or (writes and not agent.waits)
        leaf.expect({"avm_m0_write": writes, "avm_m0_read": reads, "wb_ack": acknowledged})
        leaf.expect({"avm_m0_address": address}, when=asks)
        leaf.expect({"avm_m0_writedata": word, "avm_m0_byteenable": lanes}, when=writes)
        leaf.expect({"wb_dat_r": agent.word}, when=own_answer)
        agent.clock(reads)
        stale = stale and agent.outstanding and not agent.taken
        if acknowledged:
            access, done = None if random.random() < 0.5 else access, done + 1
        if reset:
            agent.reset()
    leaf.check(settled=1)
    assert done > CYCLES // 20
    assert given_up > CYCLES // 100
