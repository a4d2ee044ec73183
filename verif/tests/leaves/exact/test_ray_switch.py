# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_switch`: the choice between a unit's own ray and its shadow ray."""

import pytest
from vectors import ports

from raycaster.configuration import configure
from raycaster.hdl.leaf import Leaf
from raycaster.rtl.common.interfaces import Eye, Slope
from raycaster.rtl.common.records import Signs, camera_of, mirror_of
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits, light_slope_bits
from raycaster.rtl.exact.ray_switch import ray_switch


@pytest.mark.parametrize("reflections", [1, 2])
def test_ray_switch(reflections, tmp_path, random):
    """All fields of one ray or of the other; the shadow ray has left no mirror."""
    config = configure(engine="exact", reflections=reflections, light=True, allow_underrun=True)
    leaf = Leaf(
        ray_switch,
        lambda: ports(
            "from_light",
            camera=camera_of(config),
            eye=Eye(eye_bits(config)),
            signs=Signs(),
            slope=Slope(exact_slope_bits(config)),
            mirror=mirror_of(config),
            shadow_signs=Signs(),
            shadow_slope=Slope(light_slope_bits(config)),
            tested_eye=Eye(eye_bits(config)),
            tested_signs=Signs(),
            tested_slope=Slope(light_slope_bits(config)),
            tested_mirror=mirror_of(config),
        ),
        tmp_path,
    )
    stimulus = [
        {name: int(random.integers(1 << member.width)) for name, member in leaf.given.items()} for _ in range(200)
    ]
    outputs = leaf.run_both(stimulus)
    for inputs, output in zip(stimulus, outputs, strict=True):
        if inputs["from_light"]:
            wanted = {f"tested_eye_{axis}": inputs[f"camera_light_{axis}"] for axis in "xyz"}
            wanted |= {f"tested_{part}": inputs[f"shadow_{part}"] for part in output_parts()} | {
                "tested_mirror_active": 0
            }
        else:
            wanted = {f"tested_eye_{axis}": inputs[f"eye_{axis}"] for axis in "xyz"}
            wanted |= {f"tested_{part}": inputs[part] for part in output_parts()}
            mirror = [name for name in output if name.startswith("tested_mirror_")]
            wanted |= {name: inputs[name.removeprefix("tested_")] for name in mirror}
        assert {name: output[name] for name in wanted} == wanted, inputs


def output_parts() -> list[str]:
    """Names of the fields that both rays have."""
    return [f"{record}_d{axis}" for record in ("signs", "slope") for axis in "xyz"]
