# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_walker`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import by_screen, flat_tables, products, row_slopes, word
from vectors import AXES, any_place, ports

from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.rect_walker import rect_walker
from raycaster.rtl.common.records import stride_of, walk_of
from raycaster.rtl.common.widths import walk_bits


@pytest.mark.slow_sets("beam-vga")
@by_screen
def test_rect_walker(config, tmp_path, random):
    """Whole rows and many first columns of rows; the ways and the bounds advance at different times."""
    leaf = Leaf(rect_walker, lambda: ports(
        "clk load step_way step_bounds", start=walk_of(config), growth=stride_of(config), walk=walk_of(config)
    ), tmp_path)  # fmt: skip
    width, names = walk_bits(config), list(walk_of(config).layout)
    columns = config.screen_geometry.columns // config.pixels
    growth_width = int(stride_of(config).layout["way_p"])
    stimulus, expected = [], {}
    for line in range(300):
        steps = columns if line < 3 else 8
        table = flat_tables(random, 1)
        camera = np.array([any_place(random) for _ in AXES])
        first, more = row_slopes(random, config, steps)
        now, then = (products(table, 0, camera, slope) for slope in (first, first + more))
        inputs = {f"start_{name}": word(now[name], width) for name in names}
        inputs |= {f"growth_{name}": word(then[name] - now[name], growth_width) for name in names}
        stimulus.append({**inputs, "load": 1})
        way = bounds = 0
        # One step more than columns, for the end of the last column.
        while min(way, bounds) < steps:
            ways, walls = (products(table, 0, camera, first + more * done) for done in (way, bounds))
            seen = [word((ways if name.startswith("way") else walls)[name], width) for name in names]
            expected[len(stimulus)] = seen
            step_way, step_bounds = (int(done < steps and random.random() < 0.9) for done in (way, bounds))
            stimulus.append({"load": 0, "step_way": step_way, "step_bounds": step_bounds})
            way, bounds = way + step_way, bounds + step_bounds
    outputs = leaf.run_both(stimulus, settled=1)
    for cycle, values in expected.items():
        assert [outputs[cycle][f"walk_{name}"] for name in names] == values, cycle
