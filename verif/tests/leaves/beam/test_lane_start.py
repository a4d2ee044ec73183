# SPDX-License-Identifier: MIT
"""`lane_start`: a rectangle's products for a row's first two columns, from those of the first and their growth."""

from beam_vectors import WALK, beam_config, flat_tables, products
from vectors import any_place, designs, named

from raycaster.golden.rays import primary_slopes
from raycaster.rtl.beam.lane_start import lane_start
from raycaster.rtl.common.records import Walk, growth_of


@designs(beam_config(screen="tiny", pixels=2), beam_config(rows=180, scale=6, pixels=2))
def test_lane_start(config, leaf_of, random):
    walks = dict.fromkeys(("first_start", "second_start"), lambda: Walk(config))
    loads = dict.fromkeys(("load", "late_load"), config.rectangles)
    leaf = leaf_of(lane_start, config, **walks, **loads, growth=lambda: growth_of(config))
    slopes = primary_slopes(config.screen_geometry)
    for _ in range(300):
        row, table = int(random.integers(len(slopes))), flat_tables(random, 1)
        camera = [any_place(random) for _ in range(3)]
        now, then = (products(table, 0, camera, slope, WALK) for slope in slopes[row, :2])
        load = random.integers(1 << config.rectangles)
        growth = {name: then[name] - now[name] for name in WALK}
        leaf.case(named("start", now) | named("growth", growth) | {"load": load})
        leaf.expect(named("first_start", now) | named("second_start", then) | {"late_load": load})
    leaf.check(latency=1)
