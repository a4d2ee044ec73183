# SPDX-License-Identifier: MIT
"""Leaf test of `colour_sum`: all shares that a pixel's rays may have; with many reflections, a random choice."""

import pytest
from arithmetic_vectors import cases, plain_shares
from vectors import by, unit_config

from raycaster.configuration import CHANNEL_BITS
from raycaster.rtl.common.widths import share_bits
from raycaster.rtl.engine.colour_sum import colour_sum


@pytest.mark.slow_sets("1", "8")
@by(colour_bits=[1, 4, 8], reflections=[0, 1, 2, 4], materials=[False, True])
def test_colour_sum(colour_bits, reflections, materials, leaf_of, random):
    config = unit_config(reflections=reflections, colour_bits=colour_bits, materials=materials)
    leaf = leaf_of(colour_sum, config, channel=CHANNEL_BITS, blended=colour_bits)
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0}
    one = 1 << (share_bits(config) - 1)
    for run_time in range(reflections + 1):
        for quarters in cases(random, run_time, list(range(5)) if materials else [2]):
            shares = plain_shares([(True, quarter) for quarter in quarters])
            for values in ([255] * len(shares), *random.integers(256, size=(8, len(shares))).tolist()):
                leaf.case({**idle, "steps_reset_colour": 1})
                for share, value in zip(shares, values, strict=True):
                    leaf.stimulus += [{**idle, "channel": random.integers(256)}] * int(random.integers(2))
                    leaf.case({**idle, "channel": value, "share": share * one, "steps_add_colour": 1})
                total = sum(share * value for share, value in zip(shares, values, strict=True))
                leaf.case(idle, {"blended": int(total) >> CHANNEL_BITS - colour_bits})
    leaf.check(settled=1)
