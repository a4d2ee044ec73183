# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_fold`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import beam_config, beam_rays, direction_ports, folded, image_of, met_last, word
from vectors import config_id, ports

from raycaster.engines.beam import FOLD_LATENCY
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.records import Reflector, fold_of, turn_of
from raycaster.rtl.common.widths import DISTANCE_BITS, exact_slope_bits


@pytest.mark.slow_sets(
    quick=["beam-vga180-s4-u1-r12-m1-c8-turn", "beam-vga240-s2-u1-r12-m2-c8-turn", "beam-vga240-s2-u1-r12-m4-c8-turn"]
)
@pytest.mark.parametrize(
    "config",
    [
        beam_config(rows=180),
        beam_config(reflections=2),
        beam_config(reflections=2, screen="tiny"),
        beam_config(rows=180, turn=True),
        beam_config(reflections=2, turn=True),
        beam_config(reflections=3, screen="tiny"),
        beam_config(reflections=4, turn=True),
    ],
    ids=config_id,
)
def test_ray_fold(config, tmp_path, random):
    """One ray per cycle, at its last mirror; its slope comes a cycle later."""
    slope_bits = exact_slope_bits(config) + 1
    leaf = Leaf(ray_fold, lambda: ports(
        "clk", before=turn_of(config), last=Reflector(), slope=Direction(slope_bits), fold=fold_of(config)
    ), tmp_path)  # fmt: skip
    rays = [ray[2:] for ray in beam_rays(random, config, 4000) if ray[-1]]
    stimulus = [{} for _ in range(len(rays) + FOLD_LATENCY + 1)]
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        before = image_of(config, camera, slope, mirrors[:-1])
        stimulus[cycle] |= {f"before_{name}": value for name, value in before.items()}
        axis, plane = mirrors[-1]
        distance, at_mirror = word(plane - int(camera[axis]), DISTANCE_BITS), len(met_last(camera, slope, mirrors)) > 1
        stimulus[cycle] |= {"last_axis": axis, "last_distance": distance, "last_at_mirror": int(at_mirror)}
        stimulus[cycle + 1] |= direction_ports("slope", config, slope)
    outputs = leaf.run_both(stimulus, settled=FOLD_LATENCY)
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        expected = {f"fold_{name}": value for name, value in folded(config, camera, slope, mirrors).items()}
        assert outputs[cycle + FOLD_LATENCY] == expected, (camera, slope, mirrors)
