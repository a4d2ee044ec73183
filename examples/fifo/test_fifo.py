# SPDX-License-Identifier: MIT
"""Tests of the queue: the same inputs in MyHDL and in Verilog, and a cocotb bench.

pytest examples/fifo            # WAVES=1 before it writes build/fifo/fifo.fst
"""

import random
from collections import deque
from pathlib import Path

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_tools.runner import get_runner
from fifo import convert, fifo, ports

from raycaster.hdl.leaf import Leaf


@pytest.mark.parametrize("place_bits", [1, 2])
def test_leaf(place_bits, tmp_path):
    """Both simulators show the items in order."""
    leaf = Leaf(fifo, lambda: ports(place_bits), tmp_path)
    inputs = {"source_valid": 2, "source_item_last": 2, "source_item_data": 256, "sink_ready": 2}
    random.seed(1)
    stimulus = [{"reset": 1}] + [
        {"reset": 0} | {name: random.randrange(limit) for name, limit in inputs.items()} for _ in range(300)
    ]
    # Only what is valid is compared, as the memory starts unknown.
    queue = deque()
    for given, seen in zip(stimulus[1:], leaf.run_verilog(stimulus)[1:], strict=True):
        assert (seen["sink_valid"], seen["source_ready"]) == (bool(queue), len(queue) < 1 << place_bits)
        assert not queue or (seen["sink_item_last"], seen["sink_item_data"]) == queue[0]
        if queue and given["sink_ready"]:
            queue.popleft()
        if given["source_valid"] and seen["source_ready"]:
            queue.append((given["source_item_last"], given["source_item_data"]))
    filled = [{"reset": 1}] + [{"reset": 0, "source_valid": 1, "source_item_data": n} for n in range(4)]
    leaf.run_both([*filled, *stimulus], settled=2)


@cocotb.test()
async def items_arrive_in_order(dut):
    """Send a packet while the receiver pauses."""
    cocotb.start_soon(Clock(dut.clk, 10, "ns").start())
    dut.reset.value, dut.source_valid.value, dut.sink_ready.value = 1, 0, 0
    for _ in range(2):
        await FallingEdge(dut.clk)
    dut.reset.value = 0
    sent, received = [*range(20)], []
    waiting = deque(sent)
    for _ in range(100):
        dut.source_valid.value = bool(waiting)
        dut.source_item_word.value = waiting[0] if waiting else 0
        dut.sink_ready.value = random.randrange(2)
        await ReadOnly()
        if dut.source_valid.value and dut.source_ready.value:
            waiting.popleft()
        if dut.sink_valid.value and dut.sink_ready.value:
            received.append(int(dut.sink_item_word.value))
        await FallingEdge(dut.clk)
    assert received == sent


def test_cocotb():
    """Build a simulation of the Verilog in Icarus, and run the cocotb test on it."""
    directory = Path("build", "fifo").resolve()
    runner = get_runner("icarus")
    runner.build(sources=convert(directory / "verilog"), hdl_toplevel="fifo", build_dir=directory, always=True)
    runner.test(hdl_toplevel="fifo", test_module=Path(__file__).stem, build_dir=directory, test_dir=directory)
