# SPDX-License-Identifier: MIT
"""`apb_bridge`: writes are accepted in their access phase, reads begin in their setup phase; some are back to back."""

from bus_vectors import CYCLES, Agent, agents, any_byte_address, any_lanes, bridge_ports
from vectors import any_word

from raycaster.rtl.bus.apb_bridge import apb_bridge


@agents
def test_apb_bridge(patience, latency, leaf_of, random):
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
