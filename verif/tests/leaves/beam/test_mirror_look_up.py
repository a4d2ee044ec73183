# SPDX-License-Identifier: MIT
"""Leaf tests of `mirror_look_up`: MyHDL and converted Verilog match the expected values on the same vectors."""

from beam_vectors import any_facets, beam_config
from vectors import check, leaf_of

from raycaster.rtl.beam.mirror_look_up import mirror_look_up
from raycaster.rtl.common.records import Reflector


def test_mirror_look_up(tmp_path, random):
    config = beam_config(screen="tiny", rectangles=5)
    stimulus, expected = [], []
    for _ in range(200):
        facets, side_by_side = any_facets(random, config)
        at_mirror, index = int(random.integers(2)), int(random.integers(config.rectangles))
        stimulus.append({"facets": side_by_side, "winner_at_mirror": at_mirror, "winner_index": index})
        expected.append({"last_at_mirror": at_mirror} | {f"last_{n}": facets[index][n] for n in ("axis", "distance")})
    check(leaf_of(mirror_look_up, tmp_path, config, last=Reflector), stimulus, expected, latency=1)
