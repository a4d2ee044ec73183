# SPDX-License-Identifier: MIT
"""Leaf tests of `wishbone_bridge`: MyHDL and converted Verilog match the expected values on the same vectors."""

from bus_vectors import ADDRESS_BITS, CYCLES, Agent, agents, any_lanes, bridge_leaf
from vectors import any_word, check


@agents
def test_wishbone_bridge(patience, latency, tmp_path, random):
    """A master waits for its answer or gives up; a later access never gets that answer."""
    leaf = bridge_leaf("wishbone", tmp_path)
    agent = Agent(random, patience, latency)
    stimulus, expected = [{"reset": 1}], [{}]
    access = None  # write, address, lanes, word
    done, given_up = 0, 0
    outstanding = stale = False
    for _ in range(CYCLES):
        reset = int(random.random() < 0.02)
        if access is not None and random.random() < 0.05:
            access, given_up = None, given_up + 1
        elif access is None and random.random() < 0.7:
            access = (
                int(random.random() < 0.5),
                int(random.integers(1 << ADDRESS_BITS)),
                any_lanes(random),
                any_word(random),
            )
        write, address, lanes, word = access or (int(random.integers(2)), 0, 0, any_word(random))
        half = int(random.integers(3))  # only cyc and stb together are an access
        stale = stale or access is None
        stimulus.append(
            {
                "reset": reset,
                "wb_cyc": int(access is not None or half == 1),
                "wb_stb": int(access is not None or half == 2),
                "wb_we": write,
                "wb_adr": address,
                "wb_sel": lanes,
                "wb_dat_w": word,
            }
            | agent.drive()
        )
        asks = access is not None and not outstanding
        own_answer = outstanding and not stale and agent.answers
        acknowledged = own_answer or (asks and write and not agent.waits)
        outputs = {
            "avm_m0_write": int(asks and write),
            "avm_m0_read": int(asks and not write),
            "wb_ack": int(acknowledged),
        }
        if asks:
            outputs |= {"avm_m0_address": address}
        if asks and write:
            outputs |= {"avm_m0_writedata": word, "avm_m0_byteenable": lanes}
        if own_answer:
            outputs |= {"wb_dat_r": agent.word}
        expected.append(outputs)
        taken = asks and not write and not agent.waits
        outstanding = taken or (outstanding and not agent.answers)
        stale = stale and outstanding and not taken
        if taken:
            agent.take()
        if acknowledged:
            access, done = None if random.random() < 0.5 else access, done + 1
        if reset:
            outstanding, agent = False, Agent(random, patience, latency)
    check(leaf, stimulus, expected, settled=1)
    assert done > CYCLES // 20
    assert given_up > CYCLES // 100
