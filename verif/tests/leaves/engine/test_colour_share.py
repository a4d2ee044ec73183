# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_share`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

import pytest
from unit_vectors import cases, plain_shares, unit_config
from vectors import check, driven, leaf_of

from raycaster.hdl.signals import tied
from raycaster.rtl.common.widths import MIRROR_BITS, share_bits
from raycaster.rtl.engine.colour_share import colour_share


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
def test_colour_share(reflections, materials, tmp_path, random):
    """Every mirror after every other one, with misses in between."""
    config = unit_config(reflections=reflections, materials=materials)
    mirror = MIRROR_BITS if materials else lambda: tied(0, MIRROR_BITS)
    leaf = leaf_of(colour_share, tmp_path, config, found_mirror=mirror, share=share_bits(config))
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
    one_ray = list(product((False, True), range(5) if materials else [2]))
    whole = 1 << (share_bits(config) - 1)
    stimulus, expected = [], {}
    for run_time in range(reflections + 1):
        for hits in cases(random, run_time, one_ray):
            stimulus.append({**idle, "steps_reset_colour": 1})
            missed = False
            # Without materials, the background of a miss gets the weight of all that would have followed.
            weighing = hits if materials else [(True, 2)] * len(hits)
            for number, ((found, quarters), share) in enumerate(zip(hits, plain_shares(weighing), strict=True)):
                # Only the hit in the cycle of the addition counts.
                other = {"found": random.integers(2), "found_mirror": random.integers(5)}
                stimulus += [{**idle, **other}] * int(random.integers(2))
                expected[len(stimulus)] = {"share": share * whole, "missed": missed}
                ray = {"found": found, "found_mirror": quarters, "steps_store_ray": number < run_time}
                stimulus.append({**idle, **ray, "steps_add_colour": 1})
                missed = missed or not found or quarters == 0
            if run_time < reflections:
                stimulus.append(idle)
    check(leaf, driven(leaf, stimulus), expected, settled=1)
