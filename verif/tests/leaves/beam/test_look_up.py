# SPDX-License-Identifier: MIT
"""Leaf test of `look_up`: each rectangle's look, with the cell's colour if it has a pattern; kept between steps."""

import pytest
from beam_vectors import any_facets, beam_config
from vectors import named

from raycaster.rtl.beam.look_up import look_up
from raycaster.rtl.common.records import Sight, Winner


@pytest.mark.parametrize("looks", [{}, {"materials": True, "patterns": True}], ids=["plain", "looks"])
def test_look_up(looks, leaf_of, random):
    config = beam_config(screen="tiny", rectangles=5, **looks)
    sights = {"sight": lambda: Sight(config) if config.patterns else Winner(config)}
    leaf = leaf_of(look_up, config, **sights)
    kept = None
    for _ in range(400):
        facets, side_by_side = any_facets(random, config)
        sight = {"valid": int(random.integers(2)), "index": int(random.integers(config.rectangles))}
        sight |= {name: int(random.integers(2)) for name in ("odd_u", "odd_v") if config.patterns}
        step = int(random.random() < 0.8) if kept else 1
        if step:
            facet = facets[sight["index"]]
            kept = {"seen_found": sight["valid"], "seen_colour": facet["colour"]}
            if config.patterns:
                odd_u, odd_v = sight["odd_u"], sight["odd_v"]
                second = (False, (odd_u + odd_v) % 2, odd_v, odd_u)[facet["kind"]]
                kept["seen_colour"] = facet["colour_2" if second else "colour"]
            if config.materials:
                kept["seen_mirror"] = facet["mirror"]
        leaf.case({"step": step, "facets": side_by_side} | named("sight", sight), kept)
    leaf.check(latency=1)
