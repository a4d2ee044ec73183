# SPDX-License-Identifier: MIT
"""Leaf test of `mirror_look_up`."""

from beam_vectors import any_facets, beam_config

from raycaster.rtl.beam.mirror_look_up import mirror_look_up
from raycaster.rtl.common.records import Reflector


def test_mirror_look_up(leaf_of, random):
    config = beam_config(screen="tiny", rectangles=5)
    leaf = leaf_of(mirror_look_up, config, last=Reflector)
    for _ in range(200):
        facets, side_by_side = any_facets(random, config)
        at_mirror, index = int(random.integers(2)), int(random.integers(config.rectangles))
        leaf.case({"facets": side_by_side, "winner_at_mirror": at_mirror, "winner_index": index})
        leaf.expect({"last_at_mirror": at_mirror} | {f"last_{n}": facets[index][n] for n in ("axis", "distance")})
    leaf.check(latency=1)
