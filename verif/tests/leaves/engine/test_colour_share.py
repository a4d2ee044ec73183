# SPDX-License-Identifier: MIT
"""Leaf test of `colour_share`: every mirror after every other one, with misses in between."""

from itertools import product

from arithmetic_vectors import cases, plain_shares
from vectors import by, unit_config

from raycaster.rtl.common.widths import share_bits
from raycaster.rtl.engine.colour_share import colour_share


@by(reflections=[0, 1, 2, 4], materials=[False, True])
def test_colour_share(reflections, materials, leaf_of, random):
    config = unit_config(reflections=reflections, materials=materials)
    leaf = leaf_of(colour_share, config)
    idle = {"steps_reset_colour": 0, "steps_add_colour": 0, "steps_store_ray": 0}
    one_ray = list(product((False, True), range(5) if materials else [2]))
    whole = 1 << (share_bits(config) - 1)
    for run_time in range(reflections + 1):
        for hits in cases(random, run_time, one_ray):
            leaf.case({**idle, "steps_reset_colour": 1})
            missed = False
            # Without materials, the background of a miss gets the weight of all that would have followed.
            weighing = hits if materials else [(True, 2)] * len(hits)
            for number, ((found, quarters), share) in enumerate(zip(hits, plain_shares(weighing), strict=True)):
                # Only the hit in the cycle of the addition counts.
                other = {"found": random.integers(2), "found_mirror": random.integers(5)}
                leaf.stimulus += [{**idle, **other}] * int(random.integers(2))
                ray = {"found": found, "found_mirror": quarters, "steps_store_ray": number < run_time}
                leaf.case({**idle, **ray, "steps_add_colour": 1}, {"share": share * whole, "missed": missed})
                missed = missed or not found or quarters == 0
            if run_time < reflections:
                leaf.case(idle)
    leaf.check(settled=1, spare=True)
