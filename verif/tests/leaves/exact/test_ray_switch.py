# SPDX-License-Identifier: MIT
"""Leaf test of `ray_switch`: all fields of one ray or of the other; the shadow ray has left no mirror."""

from vectors import by, exact_config

from raycaster.rtl.common.interfaces import Slope, Vector
from raycaster.rtl.common.records import Mirror, Signs
from raycaster.rtl.common.widths import eye_bits, light_slope_bits
from raycaster.rtl.exact.ray_switch import ray_switch

PARTS = [f"{record}_d{axis}" for record in ("signs", "slope") for axis in "xyz"]
"""Fields that both rays have."""


@by(reflections=[1, 2])
def test_ray_switch(reflections, leaf_of, random):
    config = exact_config(reflections=reflections, light=True)
    slopes = dict.fromkeys(("shadow_slope", "tested_slope"), lambda: Slope(light_slope_bits(config)))
    tested = {"tested_eye": lambda: Vector(eye_bits(config)), "tested_mirror": lambda: Mirror(config)}
    leaf = leaf_of(ray_switch, config, **slopes, **tested, shadow_signs=Signs, tested_signs=Signs)
    mirror = [name for name in leaf.given if name.startswith("mirror_")]
    for _ in range(200):
        inputs = {name: int(random.integers(1 << member.width)) for name, member in leaf.given.items()}
        if inputs["from_light"]:
            wanted = {f"tested_eye_{axis}": inputs[f"camera_light_{axis}"] for axis in "xyz"}
            wanted |= {f"tested_{part}": inputs[f"shadow_{part}"] for part in PARTS} | {"tested_mirror_active": 0}
        else:
            own = [f"eye_{axis}" for axis in "xyz"] + PARTS + mirror
            wanted = {f"tested_{name}": inputs[name] for name in own}
        leaf.case(inputs, wanted)
    leaf.check()
