# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_fold`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from beam_vectors import beam_config, beam_rays, folded, image_of, met_last
from vectors import by_axis, check, designs, leaf_of, named

from raycaster.engines.beam import FOLD_LATENCY
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.records import Reflector, room_image_of
from raycaster.rtl.common.widths import exact_slope_bits


@pytest.mark.slow_sets(
    quick=["beam-vga180-s4-u1-r12-m1-c8-turn", "beam-vga240-s2-u1-r12-m2-c8-turn", "beam-vga240-s2-u1-r12-m4-c8-turn"]
)
@designs(
    beam_config(rows=180),
    beam_config(reflections=2),
    beam_config(reflections=2, screen="tiny"),
    beam_config(rows=180, turn=True),
    beam_config(reflections=2, turn=True),
    beam_config(reflections=3, screen="tiny"),
    beam_config(reflections=4, turn=True),
)
def test_ray_fold(config, tmp_path, random):
    """One ray per cycle, at its last mirror; its slope comes a cycle later."""
    inputs = {"before": lambda: room_image_of(config), "slope": lambda: Direction(exact_slope_bits(config) + 1)}
    leaf = leaf_of(ray_fold, tmp_path, config, **inputs, last=Reflector)
    rays = [ray[2:] for ray in beam_rays(random, config, 4000) if ray[-1]]
    stimulus = [{} for _ in range(len(rays) + FOLD_LATENCY + 1)]
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        axis, plane = mirrors[-1]
        stimulus[cycle] |= named("before", image_of(camera, slope, mirrors[:-1]))
        stimulus[cycle] |= {"last_axis": axis, "last_distance": plane - int(camera[axis])}
        stimulus[cycle] |= {"last_at_mirror": len(met_last(camera, slope, mirrors)) > 1}
        stimulus[cycle + 1] |= by_axis("slope_", slope)
    expected = {cycle + FOLD_LATENCY: named("fold", folded(*ray)) for cycle, ray in enumerate(rays)}
    check(leaf, stimulus, expected, settled=FOLD_LATENCY)
