# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_sum`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from unit_vectors import cases, plain_shares, unit_config
from vectors import check, leaf_of

from raycaster.configuration import CHANNEL_BITS
from raycaster.rtl.common.widths import share_bits
from raycaster.rtl.engine.colour_sum import colour_sum


@pytest.mark.slow_sets("1", "8")
@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
@pytest.mark.parametrize("colour_bits", [1, 4, 8])
def test_colour_sum(colour_bits, reflections, materials, tmp_path, random):
    """All shares that a pixel's rays may have; with many reflections, a random choice."""
    config = unit_config(reflections=reflections, colour_bits=colour_bits, materials=materials)
    leaf = leaf_of(colour_sum, tmp_path, config, channel=CHANNEL_BITS, share=share_bits(config), blended=colour_bits)
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0}
    one = 1 << (share_bits(config) - 1)
    stimulus, expected = [], {}
    for run_time in range(reflections + 1):
        for quarters in cases(random, run_time, list(range(5)) if materials else [2]):
            shares = plain_shares([(True, quarter) for quarter in quarters])
            for values in ([255] * len(shares), *random.integers(256, size=(8, len(shares))).tolist()):
                stimulus.append({**idle, "steps_reset_colour": 1})
                for share, value in zip(shares, values, strict=True):
                    stimulus += [{**idle, "channel": random.integers(256)}] * int(random.integers(2))
                    stimulus.append({**idle, "channel": value, "share": share * one, "steps_add_colour": 1})
                total = sum(share * value for share, value in zip(shares, values, strict=True))
                expected[len(stimulus)] = {"blended": int(total) >> CHANNEL_BITS - colour_bits}
                stimulus.append(idle)
    check(leaf, stimulus, expected, settled=1)
