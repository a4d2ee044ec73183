# SPDX-License-Identifier: MIT
"""`axi4lite_bridge`: channels become valid in any order and at any distance; responses are accepted at any time."""

import pytest
from bus_vectors import CYCLES, Agent, agents, any_byte_address, any_lanes, bridge_ports
from vectors import any_word, named

from raycaster.rtl.bus.axi4lite_bridge import axi4lite_bridge


@agents
@pytest.mark.parametrize("pause", [0.0, 0.5])
def test_axi4lite_bridge(patience, latency, pause, leaf_of, random):
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
