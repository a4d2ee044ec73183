# SPDX-License-Identifier: MIT
"""Leaf tests of `lane_start`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import WALK, beam_config, flat_tables, products, word
from vectors import AXES, any_place, config_id, ports

from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.beam.lane_start import lane_start
from raycaster.rtl.common.records import growth_of, walk_of
from raycaster.rtl.common.widths import DISTANCE_BITS, walk_bits


@pytest.mark.parametrize(
    "config", [beam_config(screen="tiny", pixels=2), beam_config(rows=180, scale=6, pixels=2)], ids=config_id
)
def test_lane_start(config, tmp_path, random):
    """A rectangle's products for a row's first two columns, from those of the first and the growth per column."""
    leaf = Leaf(lane_start, lambda: ports(
        "clk", load=unsigned(config.rectangles), start=walk_of(config), growth=growth_of(config),
        late_load=unsigned(config.rectangles), first_start=walk_of(config), second_start=walk_of(config)
    ), tmp_path)  # fmt: skip
    slopes, width = primary_slopes(config.screen_geometry), walk_bits(config)
    stimulus, expected = [], []
    for _ in range(300):
        row, table = int(random.integers(len(slopes))), flat_tables(random, 1)
        camera = np.array([any_place(random) for _ in AXES])
        now, then = (products(table, 0, camera, slope) for slope in slopes[row, :2])
        load = int(random.integers(1 << config.rectangles))
        inputs = {f"start_{name}": word(now[name], width) for name in WALK}
        inputs |= {f"growth_{name}": word(then[name] - now[name], DISTANCE_BITS) for name in WALK}
        stimulus.append({**inputs, "load": load})
        starts = {"first_start": now, "second_start": then}
        wanted = {f"{lane}_{name}": word(ways[name], width) for lane, ways in starts.items() for name in WALK}
        expected.append({**wanted, "late_load": load})
    outputs = leaf.run_both([*stimulus, {}], settled=1)
    for output, wanted in zip(outputs[1:], expected, strict=True):
        assert {name: output[name] for name in wanted} == wanted
