# SPDX-License-Identifier: MIT
"""Leaf tests of `avalon_host`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from vectors import EVERY_LANE, any_strobe, any_word, check, leaf_of

from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import WORD_BITS


@pytest.mark.parametrize(("patience", "latency"), [(0.0, 1), (0.3, 4), (0.8, 9)])
def test_avalon_host(patience, latency, tmp_path, random):
    """Every access is one transfer, for any waitrequest and any latency of the agent."""
    address_bits = 6
    ports = {"address": address_bits, "data": WORD_BITS, "avm_m0": lambda: AvalonPort(address_bits)}
    stimulus, expected = [{"reset": 1}], [None]
    request = None  # strobe, address, data
    answer_in = None  # cycles until the accepted read is answered
    for _ in range(1000):
        if request is None and random.random() < 0.7:
            request = any_strobe(random), int(random.integers(1 << address_bits)), any_word(random)
        strobe, address, data = request or (any_strobe(random), 0, 0)
        wait, word = int(random.random() < patience), any_word(random)
        answered = answer_in == 0
        reading, writing = request is not None and strobe == 0, request is not None and strobe != 0
        stimulus.append({
            "reset": 0, "access_select": request is not None, "strobe": strobe, "address": address, "data": data,
            "avm_m0_readdata": word, "avm_m0_readdatavalid": answered, "avm_m0_waitrequest": wait,
        })  # fmt: skip
        read = reading and answer_in is None
        ready = answered or (writing and not wait)
        outputs = {"access_ready": ready, "avm_m0_read": read, "avm_m0_write": writing}
        outputs["access_word"] = word if answered else None
        if read or writing:
            outputs |= {"avm_m0_address": address, "avm_m0_byteenable": strobe or EVERY_LANE}
        outputs["avm_m0_writedata"] = data if writing else None
        expected.append(outputs)
        if ready:
            request = answer_in = None
        elif answer_in is not None:
            answer_in -= 1
        elif read and not wait:
            answer_in = int(random.integers(latency))
    check(leaf_of(avalon_host, tmp_path, **ports), stimulus, expected, settled=1)
