# SPDX-License-Identifier: MIT
"""Leaf tests of `lane_start`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import WALK, beam_config, flat_tables, products
from vectors import any_place, check, config_id, leaf_of, named

from raycaster.golden.rays import primary_slopes
from raycaster.rtl.beam.lane_start import lane_start
from raycaster.rtl.common.records import growth_of, walk_of


@pytest.mark.parametrize(
    "config", [beam_config(screen="tiny", pixels=2), beam_config(rows=180, scale=6, pixels=2)], ids=config_id
)
def test_lane_start(config, tmp_path, random):
    """A rectangle's products for a row's first two columns, from those of the first and the growth per column."""
    walks = {name: lambda: walk_of(config) for name in ("start", "first_start", "second_start")}
    loads = dict.fromkeys(("load", "late_load"), config.rectangles)
    leaf = leaf_of(lane_start, tmp_path, **walks, **loads, growth=lambda: growth_of(config))
    slopes, stimulus, expected = primary_slopes(config.screen_geometry), [], []
    for _ in range(300):
        row, table = int(random.integers(len(slopes))), flat_tables(random, 1)
        camera = [any_place(random) for _ in range(3)]
        now, then = (products(table, 0, camera, slope, WALK) for slope in slopes[row, :2])
        load = random.integers(1 << config.rectangles)
        growth = {name: then[name] - now[name] for name in WALK}
        stimulus.append(named("start", now) | named("growth", growth) | {"load": load})
        expected.append(named("first_start", now) | named("second_start", then) | {"late_load": load})
    check(leaf, stimulus, expected, latency=1)
