# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_control`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from fates import check_control
from vectors import any_config, config_id

from raycaster.rtl.seed.ray_control import ray_control


@pytest.mark.slow_sets("seed-vga240-u32-r12", "seed-vga240-u32-r32", "seed-vga240-u32-r8")
@pytest.mark.parametrize(
    "config",
    [
        any_config(rectangles=rectangles, reflections=reflections, fraction_bits=bits, divider_bits=divider_bits)
        for rectangles, reflections, bits, divider_bits in (
            (1, 0, 0, 1), (1, 2, 8, 1), (2, 1, 0, 3), (3, 2, 0, 3), (5, 1, 4, 2), (8, 2, 1, 2), (12, 1, 0, 1),
            (12, 2, 0, 3), (32, 1, 8, 3),
        )
    ]
    + [any_config(rectangles=5, reflections=2, culling=False)],
    ids=config_id,
)  # fmt: skip
def test_ray_control(config, tmp_path, random):
    """Rows of any rectangles and fates, with every number of cycles per rectangle."""
    check_control(ray_control, config, tmp_path, random)
