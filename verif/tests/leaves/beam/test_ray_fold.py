# SPDX-License-Identifier: MIT
"""Leaf test of `ray_fold`: one ray per cycle, at its last mirror; its slope comes a cycle later."""

from beam_vectors import beam_config, beam_rays, folded, image_of, met_last
from vectors import by_axis, designs, named

from raycaster.rtl.beam.latencies import FOLD_LATENCY
from raycaster.rtl.beam.ray_fold import ray_fold
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.records import Reflector, RoomImage
from raycaster.rtl.common.widths import exact_slope_bits


@designs(
    beam_config(rows=180),
    beam_config(reflections=2),
    beam_config(reflections=2, screen="tiny"),
    beam_config(rows=180, turn=True),
    beam_config(reflections=2, turn=True),
    beam_config(reflections=3, screen="tiny"),
    beam_config(reflections=4, turn=True),
    quick=["beam-tiny48-s2-u1-r12-m3-c8", "beam-vga180-s4-u1-r12-m1-c8-turn", "beam-vga240-s2-u1-r12-m4-c8-turn"],
)
def test_ray_fold(config, leaf_of, random):
    inputs = {"before": lambda: RoomImage(config), "slope": lambda: Vector(exact_slope_bits(config) + 1)}
    leaf = leaf_of(ray_fold, config, **inputs, last=Reflector)
    rays = [ray[2:] for ray in beam_rays(random, config, leaf.some(4000)) if ray[-1]]
    leaf.stimulus = [{} for _ in range(len(rays) + FOLD_LATENCY + 1)]
    for cycle, (camera, slope, mirrors) in enumerate(rays):
        axis, plane = mirrors[-1]
        leaf.stimulus[cycle] |= named("before", image_of(camera, slope, mirrors[:-1]))
        leaf.stimulus[cycle] |= {"last_axis": axis, "last_distance": plane - int(camera[axis])}
        leaf.stimulus[cycle] |= {"last_at_mirror": len(met_last(camera, slope, mirrors)) > 1}
        leaf.stimulus[cycle + 1] |= by_axis("slope_", slope)
        leaf.expected[cycle + FOLD_LATENCY] = named("fold", folded(camera, slope, mirrors))
    leaf.check(settled=FOLD_LATENCY)
