# SPDX-License-Identifier: MIT
"""Leaf test of `ray_mem`: the hit point, and the ray's signs with one reversed; kept until the next step."""

import pytest
from vectors import by_axis, unit_config

from raycaster.rtl.common.records import Origin, Ray
from raycaster.rtl.common.widths import AXIS_BITS, position_bits
from raycaster.rtl.seed.ray_mem import ray_mem
from raycaster.verif.random_world import EXTREMES


@pytest.mark.parametrize(
    "config", [unit_config(fraction_bits=bits) for bits in (0, 3, 8)], ids=lambda config: f"F{config.fraction_bits}"
)
def test_ray_mem(config, leaf_of, random):
    rays = dict.fromkeys(("ray", "reflected"), lambda: Ray(config))
    leaf = leaf_of(ray_mem, config, **rays, found_axis=AXIS_BITS, found_point=lambda: Origin(config))
    values = [*EXTREMES, (1 << position_bits(config)) - 1]
    reflected = None
    for number in range(300):
        store, found = int(number == 0 or random.random() < 0.7), number % 3
        point = [int(random.choice(values)) for _ in range(3)]
        signs = [int(random.integers(2)) for _ in range(3)]
        ray = by_axis("ray_d", signs) | by_axis("ray_", [int(random.choice(values)) for _ in range(3)])
        leaf.case({"steps_store_ray": store, "found_axis": found, **by_axis("found_point_", point), **ray}, reflected)
        if store:
            turned = [sign ^ (axis == found) for axis, sign in enumerate(signs)]
            reflected = by_axis("reflected_", point) | by_axis("reflected_d", turned)
    leaf.check(settled=1)
