# SPDX-License-Identifier: MIT
"""Leaf test of `avalon_host`: every access is one transfer, for any waitrequest and any latency of the agent."""

import pytest
from vectors import EVERY_LANE, any_strobe, any_word, named

from raycaster.rtl.bus.avalon_host import avalon_host
from raycaster.rtl.common.interfaces import AvalonPort

ADDRESS_BITS = 6


@pytest.mark.parametrize(("patience", "latency"), [(0.0, 1), (0.3, 4), (0.8, 9)])
def test_avalon_host(patience, latency, leaf_of, random):
    leaf = leaf_of(avalon_host, address=ADDRESS_BITS, avm_m0=lambda: AvalonPort(ADDRESS_BITS))
    leaf.case({"reset": 1})
    request = None  # strobe, address, data
    answer_in = None  # cycles until the accepted read is answered
    for _ in range(1000):
        if request is None and random.random() < 0.7:
            request = any_strobe(random), int(random.integers(1 << ADDRESS_BITS)), any_word(random)
        strobe, address, data = request or (any_strobe(random), 0, 0)
        wait, word = int(random.random() < patience), any_word(random)
        answered = answer_in == 0
        reading, writing = request is not None and strobe == 0, request is not None and strobe != 0
        agent = {"readdata": word, "readdatavalid": answered, "waitrequest": wait}
        access = {"access_select": request is not None, "strobe": strobe, "address": address, "data": data}
        leaf.case({"reset": 0, **access, **named("avm_m0", agent)})
        read = reading and answer_in is None
        ready = answered or (writing and not wait)
        leaf.expect({"access_ready": ready, "avm_m0_read": read, "avm_m0_write": writing})
        leaf.expect({"access_word": word}, when=answered)
        leaf.expect({"avm_m0_address": address, "avm_m0_byteenable": strobe or EVERY_LANE}, when=read or writing)
        leaf.expect({"avm_m0_writedata": data}, when=writing)
        if ready:
            request = answer_in = None
        elif answer_in is not None:
            answer_in -= 1
        elif read and not wait:
            answer_in = int(random.integers(latency))
    leaf.check(settled=1)
