# SPDX-License-Identifier: MIT
"""Leaf tests of `axi4lite_bridge`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from bus_vectors import CYCLES, Agent, agents, any_byte_address, any_lanes, bridge_leaf
from vectors import any_word, check


@agents
@pytest.mark.parametrize("pause", [0.0, 0.5])
def test_axi4lite_bridge(patience, latency, pause, tmp_path, random):
    """Channels become valid in any order and at any distance; responses are accepted at any time."""
    leaf = bridge_leaf("axi4lite", tmp_path)
    agent = Agent(random, patience, latency)
    stimulus, expected = [{"reset": 1}], [{}]
    written, read = 0, 0
    address = word = asked = None  # what is valid on the manager's three channels
    taken_write = taken_read = response = outstanding = answer = read_waits = False
    for _ in range(CYCLES):
        reset = int(random.random() < 0.02)
        if reset:
            address = word = asked = None
        else:
            address = any_byte_address(random) if address is None and random.random() >= pause else address
            word = (any_word(random), any_lanes(random)) if word is None and random.random() >= pause else word
            asked = any_byte_address(random) if asked is None and random.random() >= pause else asked
        bready, rready = (int(random.random() >= pause) for _ in range(2))
        stimulus.append(
            {
                "reset": reset,
                "s_axi_awaddr": any_byte_address(random) if address is None else address,
                "s_axi_awvalid": int(address is not None),
                "s_axi_wdata": word[0] if word else any_word(random),
                "s_axi_wstrb": word[1] if word else any_lanes(random),
                "s_axi_wvalid": int(word is not None),
                "s_axi_bready": bready,
                "s_axi_araddr": any_byte_address(random) if asked is None else asked,
                "s_axi_arvalid": int(asked is not None),
                "s_axi_rready": rready,
            }
            | agent.drive()
        )
        answer = answer or agent.answers
        write = address is not None and word is not None and not taken_write and not read_waits
        write = write and not (response and not bready)
        reads = asked is not None and not write and not taken_read and not outstanding and not answer
        outputs = {
            "avm_m0_write": int(write),
            "avm_m0_read": int(reads),
            "s_axi_awready": int(taken_write),
            "s_axi_wready": int(taken_write),
            "s_axi_bvalid": int(response),
            "s_axi_bresp": 0,
            "s_axi_arready": int(taken_read),
            "s_axi_rvalid": int(answer),
            "s_axi_rresp": 0,
        }
        if write:
            outputs |= {"avm_m0_address": address // 4, "avm_m0_writedata": word[0], "avm_m0_byteenable": word[1]}
        if reads:
            outputs |= {"avm_m0_address": asked // 4}
        if answer:
            outputs |= {"s_axi_rdata": agent.word}
        expected.append(outputs)
        written, read = written + (response and bready), read + (answer and rready)
        response = taken_write or (response and not bready)
        if taken_write:
            address = word = None
        if taken_read:
            asked = None
        taken_write, taken_read = write and not agent.waits, reads and not agent.waits
        read_waits = reads and agent.waits
        outstanding = taken_read or (outstanding and not agent.answers)
        answer = answer and not rready
        if taken_read:
            agent.take()
        if reset:
            taken_write = taken_read = response = outstanding = answer = read_waits = False
            agent = Agent(random, patience, latency)
    check(leaf, stimulus, expected, settled=1)
    assert min(written, read) > CYCLES // 40
