# SPDX-License-Identifier: MIT
"""Leaf test of `ray_control`: rows of any rectangles and fates, with every number of cycles per rectangle."""

from fates import check_control, control_leaf
from vectors import any_config, designs

from raycaster.rtl.seed.ray_control import ray_control


@designs(
    any_config(rectangles=1, reflections=0, divider_bits=1),
    any_config(rectangles=1, reflections=2, fraction_bits=8, divider_bits=1),
    any_config(rectangles=2, reflections=1, divider_bits=3),
    any_config(rectangles=3, reflections=2, divider_bits=3),
    any_config(rectangles=5, reflections=1, fraction_bits=4, divider_bits=2),
    any_config(rectangles=8, reflections=2, fraction_bits=1, divider_bits=2),
    any_config(rectangles=12, reflections=1, divider_bits=1),
    any_config(rectangles=12, reflections=2, divider_bits=3),
    any_config(rectangles=32, reflections=1, fraction_bits=8, divider_bits=3),
    any_config(rectangles=5, reflections=2, culling=False),
    slow=["seed-vga240-u32-r12", "seed-vga240-u32-r32", "seed-vga240-u32-r8"],
)
def test_ray_control(config, leaf_of, random):
    check_control(control_leaf(leaf_of, ray_control, config), config, random)
