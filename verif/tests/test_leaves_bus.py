# SPDX-License-Identifier: MIT
"""The bridges from other buses to Avalon-MM: MyHDL's simulator, the converted Verilog and a model on one stimulus.

The models say of each cycle, from the blocks' contracts, what the agent is asked for and what the master sees.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from raycaster.buses import BUSES
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import LANES, WORD_BITS, bit
from raycaster.verif.leaf import Leaf, reset_signal
from raycaster.verif.seeds import repeat, seed

ADDRESS_BITS = 6
CYCLES = 1500

agents = pytest.mark.parametrize(("patience", "latency"), [(0.0, 2), (0.3, 4), (0.8, 7)])
"""How often the agent makes wait, and how many cycles it takes for an answer at most."""


class Agent:
    """An Avalon-MM agent that makes wait and answers at random."""

    def __init__(self, random: np.random.Generator, patience: float, latency: int):
        self._random, self._patience, self._latency = random, patience, latency
        self._due = None  # cycles until a read that was taken is answered
        self.word = self.waits = self.answers = 0

    def drive(self) -> dict[str, int]:
        """What it drives in this cycle; readdata changes with an answer only."""
        self.answers = int(self._due == 0)
        self._due = None if self._due in (None, 0) else self._due - 1
        self.waits = int(self._random.random() < self._patience)
        if self.answers:
            self.word = any_word(self._random)
        return {
            "avm_m0_readdata": self.word,
            "avm_m0_readdatavalid": self.answers,
            "avm_m0_waitrequest": self.waits,
        }

    def take(self) -> None:
        """It takes a read in this cycle; the answer comes two cycles later at the earliest."""
        self._due = int(self._random.integers(1, self._latency))


def any_word(random: np.random.Generator) -> int:
    return int(random.integers(1 << WORD_BITS))


def any_lanes(random: np.random.Generator) -> int:
    return int(random.integers(1 << LANES))


def any_byte_address(random: np.random.Generator) -> int:
    """Whichever of a word's bytes it says, it is the word's."""
    return int(random.integers(4 << ADDRESS_BITS))


def bridge_leaf(name: str, directory: Path) -> Leaf:
    bridge = BRIDGES[name]
    return Leaf(
        bridge.block,
        lambda: {
            "clk": bit(),
            "reset": reset_signal(),
            BUSES[name].port: bridge.interface(ADDRESS_BITS),
            "avm_m0": AvalonPort(ADDRESS_BITS),
        },
        directory,
    )


def check(leaf: Leaf, stimulus: list[dict[str, int]], expected: list[dict[str, int]]) -> None:
    """Whatever a model expects, and in no cycle anything unknown after the reset."""
    for cycle, (output, wanted) in enumerate(zip(leaf.run_both(stimulus, settled=1), expected, strict=True)):
        for name, value in wanted.items():
            assert output[name] == value, f"{name} is {output[name]}, expected {value}, cycle {cycle}; {repeat()}"


# axi4lite_bridge ------------------------------------------------------------------------------------------------------


@agents
@pytest.mark.parametrize("pause", [0.0, 0.5])
def test_axi4lite_bridge(patience, latency, pause, tmp_path):
    """Channels come in any order and at any distance, and responses are taken at any time."""
    leaf = bridge_leaf("axi4lite", tmp_path)
    random = np.random.default_rng(seed())
    agent = Agent(random, patience, latency)
    stimulus: list[dict[str, int]] = [{"reset": 1}]
    expected: list[dict[str, int]] = [{}]
    written, read = 0, 0
    address = word = asked = None  # what stands on the three channels of the manager
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
    check(leaf, stimulus, expected)
    assert min(written, read) > CYCLES // 40


# wishbone_bridge ------------------------------------------------------------------------------------------------------


@agents
def test_wishbone_bridge(patience, latency, tmp_path):
    """A master takes what it asked for, or gives up; then nobody else gets its answer."""
    leaf = bridge_leaf("wishbone", tmp_path)
    random = np.random.default_rng(seed())
    agent = Agent(random, patience, latency)
    stimulus: list[dict[str, int]] = [{"reset": 1}]
    expected: list[dict[str, int]] = [{}]
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
        half = int(random.integers(3))  # cyc and stb are an access only together
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
    check(leaf, stimulus, expected)
    assert done > CYCLES // 20
    assert given_up > CYCLES // 100


# apb_bridge -----------------------------------------------------------------------------------------------------------


@agents
def test_apb_bridge(patience, latency, tmp_path):
    """Writes are taken in their access phase, reads begin in their setup phase; some follow one another at once."""
    leaf = bridge_leaf("apb", tmp_path)
    random = np.random.default_rng(seed())
    agent = Agent(random, patience, latency)
    stimulus: list[dict[str, int]] = [{"reset": 1}]
    expected: list[dict[str, int]] = [{}]
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
    check(leaf, stimulus, expected)
    assert done > CYCLES // 20
