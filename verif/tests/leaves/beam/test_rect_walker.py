# SPDX-License-Identifier: MIT
"""`rect_walker`: whole rows and many first columns of rows; the ways and the bounds advance at different times."""

import numpy as np
import pytest
from beam_vectors import by_screen, flat_tables, products, row_slopes
from vectors import any_place, named

from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.common.records import Walk, stride_of


@pytest.mark.slow_sets("beam-vga")
@by_screen
def test_rect_walker(config, leaf_of, random):
    walks = {"start": lambda: Walk(config), "growth": lambda: stride_of(config)}
    leaf, names = leaf_of(rect_walker, config, **walks), list(Walk(config).layout)
    columns = config.screen_geometry.columns // config.pixels
    for line in range(300):
        steps = columns if line < 3 else 8
        table = flat_tables(random, 1)
        camera = np.array([any_place(random) for _ in range(3)])
        first, more = row_slopes(random, config, steps)
        now, then = (products(table, 0, camera, slope, names) for slope in (first, first + more))
        growth = {name: then[name] - now[name] for name in names}
        leaf.case(named("start", now) | named("growth", growth) | {"load": 1})
        way = bounds = 0
        # One step more than columns, for the end of the last column.
        while min(way, bounds) < steps:
            ways, walls = (products(table, 0, camera, first + more * done, names) for done in (way, bounds))
            ways = {name: value for name, value in ways.items() if name.startswith("way")}
            leaf.expected[leaf.cycle] = named("walk", walls | ways)
            step_way, step_bounds = (int(done < steps and random.random() < 0.9) for done in (way, bounds))
            leaf.case({"load": 0, "step_way": step_way, "step_bounds": step_bounds})
            way, bounds = way + step_way, bounds + step_bounds
    leaf.check(settled=1)
