# SPDX-License-Identifier: MIT
"""Leaf tests of `avalon_host`: MyHDL and converted Verilog match the expected values on the same vectors."""

from __future__ import annotations

import pytest
from vectors import EVERY_LANE, any_strobe, any_word, ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.common.interfaces import Access, AvalonPort
from raycaster.rtl.common.widths import LANES, WORD_BITS


@pytest.mark.parametrize(("patience", "latency"), [(0.0, 1), (0.3, 4), (0.8, 9)])
def test_avalon_host(patience, latency, tmp_path, random):
    """Every access is one transfer, for any waitrequest and any latency of the agent."""
    address_bits = 6
    leaf = Leaf(avalon_host, lambda: ports(
        "clk reset", access=Access(), strobe=unsigned(LANES), address=unsigned(address_bits),
        data=unsigned(WORD_BITS), avm_m0=AvalonPort(address_bits)
    ), tmp_path)  # fmt: skip
    stimulus = [{"reset": 1}]
    expected = [{}]
    request = None  # strobe, address, data
    answer_in = None  # cycles until the accepted read is answered
    for _ in range(1000):
        if request is None and random.random() < 0.7:
            request = any_strobe(random), int(random.integers(1 << address_bits)), any_word(random)
        strobe, address, data = request or (any_strobe(random), 0, 0)
        wait, word = int(random.random() < patience), any_word(random)
        answered = answer_in == 0
        reading, writing = request is not None and strobe == 0, request is not None and strobe != 0
        stimulus.append(
            {
                "reset": 0,
                "access_select": int(request is not None),
                "strobe": strobe,
                "address": address,
                "data": data,
                "avm_m0_readdata": word,
                "avm_m0_readdatavalid": int(answered),
                "avm_m0_waitrequest": wait,
            }
        )
        read = reading and answer_in is None
        outputs = {
            "access_ready": int(answered or (writing and not wait)),
            "avm_m0_read": int(read),
            "avm_m0_write": int(writing),
        }
        if answered:
            outputs["access_word"] = word
        if read or writing:
            outputs |= {"avm_m0_address": address, "avm_m0_byteenable": strobe or EVERY_LANE}
        if writing:
            outputs["avm_m0_writedata"] = data
        expected.append(outputs)
        if outputs["access_ready"]:
            request = answer_in = None
        elif answer_in is not None:
            answer_in -= 1
        elif read and not wait:
            answer_in = int(random.integers(latency))
    for cycle, (output, wanted) in enumerate(zip(leaf.run_both(stimulus, settled=1), expected, strict=True)):
        assert wanted.items() <= output.items(), cycle
