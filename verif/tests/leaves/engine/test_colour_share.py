# SPDX-License-Identifier: MIT
"""Leaf tests of `colour_share`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

import pytest
from unit_vectors import any_config, cases, plain_shares
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import tied, unsigned
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.widths import MIRROR_BITS, share_bits
from raycaster.rtl.engine.colour_share import colour_share


@pytest.mark.parametrize("materials", [False, True])
@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
def test_colour_share(reflections, materials, tmp_path, random):
    """Every mirror after every other one, with misses in between."""
    config = any_config(reflections=reflections, materials=materials)
    leaf = Leaf(colour_share, lambda: ports(
        "clk found missed", steps=Steps(), found_mirror=unsigned(MIRROR_BITS) if materials else tied(0, MIRROR_BITS),
        share=unsigned(share_bits(config)), config=config
    ), tmp_path)  # fmt: skip
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
    one_ray = list(product((False, True), range(5) if materials else [2]))
    whole = 1 << (share_bits(config) - 1)
    stimulus, results = [], []
    for run_time in range(reflections + 1):
        for hits in cases(random, run_time, one_ray):
            stimulus.append({**idle, "steps_reset_colour": 1})
            missed = False
            # Without materials, the background of a miss gets the weight of all that would have followed.
            weighing = hits if materials else [(True, 2)] * len(hits)
            for number, ((found, quarters), share) in enumerate(zip(hits, plain_shares(weighing), strict=True)):
                # Only the hit in the cycle of the addition counts.
                other = {"found": int(random.integers(2)), "found_mirror": int(random.integers(5))}
                stimulus += [{**idle, **other}] * int(random.integers(2))
                results.append((len(stimulus), share * whole, missed, hits))
                ray = {"found": int(found), "found_mirror": quarters, "steps_store_ray": int(number < run_time)}
                stimulus.append({**idle, **ray, "steps_add_colour": 1})
                missed = missed or not found or quarters == 0
            if run_time < reflections:
                stimulus.append(idle)
    stimulus = [{name: value for name, value in cycle.items() if name in leaf.given} for cycle in stimulus]
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, share, missed, hits in results:
        assert outputs[cycle]["share"] == share, hits
        assert outputs[cycle]["missed"] == missed, hits
