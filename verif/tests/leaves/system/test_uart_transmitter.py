# SPDX-License-Identifier: MIT
"""Leaf tests of `uart_transmitter`."""

from vectors import any_strobe, by

from raycaster.memory_map import clocks_per_bit
from raycaster.rtl.system.uart_transmitter import DATA_BITS, FRAME_BITS, uart_transmitter


def test_clocks_per_bit():
    """Rounded rates are close enough: a receiver tolerates a few per cent."""
    assert [clocks_per_bit(hz) for hz in (50_000_000, 25_000_000, 6_000_000)] == [434, 217, 52]


@by(clocks=[2, 5, 16])
def test_uart_transmitter(clocks, leaf_of, random):
    """A byte is accepted when the line is free; reading shows whether it is busy."""
    leaf = leaf_of(uart_transmitter, data=DATA_BITS, clocks_per_bit=clocks)
    leaf.case({"reset": 1})
    request, sending = None, []  # levels of the line that are still to be sent
    for _ in range(400 * clocks):
        if request is None and random.random() < 0.1:
            request = any_strobe(random), int(random.integers(1 << DATA_BITS))
        strobe, data = request or (any_strobe(random), 0)
        reset = int(random.random() < 0.2 / (FRAME_BITS * clocks))
        leaf.case({"reset": reset, "access_select": request is not None, "strobe": strobe, "data": data})
        writes = request is not None and strobe & 1
        ready = request is not None and not (writes and sending)
        line = sending[0] if sending else 1
        leaf.expect({"uart_tx": line, "access_word": bool(sending), "access_ready": ready})
        if ready:
            request = None
        if reset:
            sending = []
        elif sending:
            sending = sending[1:]
        elif writes:
            levels = [0, *(data >> index & 1 for index in range(DATA_BITS)), 1]
            sending = [level for level in levels for _ in range(clocks)]
    leaf.check(settled=1)
