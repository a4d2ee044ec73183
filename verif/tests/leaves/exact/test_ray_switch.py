# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_switch`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from exact_vectors import exact_config
from vectors import check, leaf_of

from raycaster.rtl.common.interfaces import Eye, Slope
from raycaster.rtl.common.records import Signs, mirror_of
from raycaster.rtl.common.widths import eye_bits, light_slope_bits
from raycaster.rtl.exact.ray_switch import ray_switch

PARTS = [f"{record}_d{axis}" for record in ("signs", "slope") for axis in "xyz"]
"""Fields that both rays have."""


@pytest.mark.parametrize("reflections", [1, 2])
def test_ray_switch(reflections, tmp_path, random):
    """All fields of one ray or of the other; the shadow ray has left no mirror."""
    config = exact_config(reflections=reflections, light=True)
    slopes = dict.fromkeys(("shadow_slope", "tested_slope"), lambda: Slope(light_slope_bits(config)))
    tested = {"tested_eye": lambda: Eye(eye_bits(config)), "tested_mirror": lambda: mirror_of(config)}
    leaf = leaf_of(ray_switch, tmp_path, config, **slopes, **tested, shadow_signs=Signs, tested_signs=Signs)
    mirror = [name for name in leaf.given if name.startswith("mirror_")]
    stimulus, expected = [], []
    for _ in range(200):
        inputs = {name: int(random.integers(1 << member.width)) for name, member in leaf.given.items()}
        stimulus.append(inputs)
        if inputs["from_light"]:
            wanted = {f"tested_eye_{axis}": inputs[f"camera_light_{axis}"] for axis in "xyz"}
            wanted |= {f"tested_{part}": inputs[f"shadow_{part}"] for part in PARTS} | {"tested_mirror_active": 0}
        else:
            own = [f"eye_{axis}" for axis in "xyz"] + PARTS + mirror
            wanted = {f"tested_{name}": inputs[name] for name in own}
        expected.append(wanted)
    check(leaf, stimulus, expected)
