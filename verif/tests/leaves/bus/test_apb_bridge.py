# SPDX-License-Identifier: MIT
"""Leaf tests of `apb_bridge`: MyHDL and converted Verilog match the expected values on the same vectors."""

from bus_vectors import CYCLES, Agent, agents, any_byte_address, any_lanes, bridge_leaf
from vectors import any_word, check


@agents
def test_apb_bridge(patience, latency, tmp_path, random):
    """Writes are accepted in their access phase, reads begin in their setup phase; some accesses are back to back."""
    leaf = bridge_leaf("apb", tmp_path)
    agent = Agent(random, patience, latency)
    stimulus, expected = [{"reset": 1}], [{}]
    access = None  # write, address, lanes, word
    enable = outstanding = False
    done = 0
    for _ in range(CYCLES):
        reset = int(random.random() < 0.02)
        if reset:
            access, enable = None, False
        elif access is None and random.random() < 0.7:
            access = int(random.random() < 0.5), any_byte_address(random), any_lanes(random), any_word(random)
        write, address, lanes, word = access or (int(random.integers(2)), 0, 0, any_word(random))
        stimulus.append(
            {
                "reset": reset,
                "s_apb_psel": int(access is not None),
                "s_apb_penable": int(enable if access else random.integers(2)),
                "s_apb_pwrite": write,
                "s_apb_paddr": address,
                "s_apb_pwdata": word,
                "s_apb_pstrb": lanes,
            }
            | agent.drive()
        )
        writes = access is not None and write and enable
        reads = access is not None and not write and not outstanding
        ready = (writes and not agent.waits) or (outstanding and agent.answers)
        outputs = {"avm_m0_write": int(writes), "avm_m0_read": int(reads), "s_apb_pslverr": 0}
        if enable:
            outputs |= {"s_apb_pready": int(ready)}
        if writes or reads:
            outputs |= {"avm_m0_address": address // 4}
        if writes:
            outputs |= {"avm_m0_writedata": word, "avm_m0_byteenable": lanes}
        if ready and not write:
            outputs |= {"s_apb_prdata": agent.word}
        expected.append(outputs)
        taken = reads and not agent.waits
        outstanding = taken or (outstanding and not agent.answers)
        if taken:
            agent.take()
        enable = access is not None and not ready
        if ready:
            access, done = None, done + 1
        if reset:
            outstanding, agent = False, Agent(random, patience, latency)
    check(leaf, stimulus, expected, settled=1)
    assert done > CYCLES // 20
