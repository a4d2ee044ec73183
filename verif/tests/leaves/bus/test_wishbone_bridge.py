# SPDX-License-Identifier: MIT
"""Leaf test of `wishbone_bridge`: a master waits for its answer or gives up; a later access never gets that answer."""

from bus_vectors import ADDRESS_BITS, CYCLES, Agent, agents, any_lanes, bridge_ports
from vectors import any_word, named

from raycaster.rtl.bus.wishbone_bridge import wishbone_bridge


@agents
def test_wishbone_bridge(patience, latency, leaf_of, random):
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
