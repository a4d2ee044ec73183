# SPDX-License-Identifier: MIT
"""Leaf tests of `uart_transmitter`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from vectors import any_strobe, ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.memory_map import clocks_per_bit
from raycaster.rtl.common.interfaces import Access
from raycaster.rtl.common.widths import LANES
from raycaster.rtl.system.uart_transmitter import DATA_BITS, FRAME_BITS, uart_transmitter


def test_clocks_per_bit():
    """Rounded rates are close enough: a receiver tolerates a few per cent."""
    assert [clocks_per_bit(hz) for hz in (50_000_000, 25_000_000, 6_000_000)] == [434, 217, 52]


@pytest.mark.parametrize("clocks", [2, 5, 16])
def test_uart_transmitter(clocks, tmp_path, random):
    leaf = Leaf(uart_transmitter, lambda: ports(
        "clk reset uart_tx", access=Access(), strobe=unsigned(LANES), data=unsigned(DATA_BITS), clocks_per_bit=clocks
    ), tmp_path)  # fmt: skip
    stimulus = [{"reset": 1}]
    line, busy, ready = [None], [None], [None]
    request, sending = None, []  # levels of the line that are still to be sent
    for _ in range(400 * clocks):
        if request is None and random.random() < 0.1:
            request = any_strobe(random), int(random.integers(1 << DATA_BITS))
        strobe, data = request or (any_strobe(random), 0)
        reset = int(random.random() < 0.2 / (FRAME_BITS * clocks))
        stimulus.append({"reset": reset, "access_select": int(request is not None), "strobe": strobe, "data": data})
        writes = request is not None and strobe & 1
        line.append(sending[0] if sending else 1)
        busy.append(int(bool(sending)))
        ready.append(int(request is not None and not (writes and sending)))
        if ready[-1]:
            request = None
        if reset:
            sending = []
        elif sending:
            sending = sending[1:]
        elif writes:
            levels = [0, *(data >> index & 1 for index in range(DATA_BITS)), 1]
            sending = [level for level in levels for _ in range(clocks)]
    for cycle, output in enumerate(leaf.run_both(stimulus, settled=1)):
        if cycle:
            wanted = {"uart_tx": line[cycle], "access_word": busy[cycle], "access_ready": ready[cycle]}
            assert output == wanted, cycle
