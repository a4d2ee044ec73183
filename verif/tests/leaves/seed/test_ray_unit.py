# SPDX-License-Identifier: MIT
"""Leaf test of `ray_unit`."""

from engine_vectors import check_ray_unit
from vectors import any_config, designs

from raycaster.rtl.seed.ray_unit import ray_unit

FINE = {"reflections": 2, "fraction_bits": 8, "rounding": "nearest", "divider_bits": 2}
LOOKS = {"materials": True, "patterns": True}


@designs(
    any_config(units=32, rectangles=8, reflections=1, divider_bits=1),
    any_config(units=5, rectangles=8, reflections=2, rounding="nearest", divider_bits=3, colour_bits=4),
    any_config(screen="tiny", units=2, rectangles=3, reflections=0, divider_bits=2),
    any_config(units=1, rectangles=8, reflections=2, fraction_bits=1, divider_bits=2, colour_bits=5),
    any_config(units=320, rectangles=7, reflections=2, fraction_bits=4, rounding="nearest", divider_bits=3),
    any_config(units=64, rectangles=8, reflections=1, fraction_bits=4, divider_bits=1, colour_bits=1),
    any_config(screen="tiny", units=16, rectangles=8, **FINE),
    any_config(units=40, rectangles=8, reflections=2, fraction_bits=8, divider_bits=3),
    any_config(units=16, rectangles=8, reflections=2, culling=False),
    any_config(units=16, rectangles=8, reflections=1, materials=True),
    any_config(units=32, rectangles=8, reflections=2, fraction_bits=3, **LOOKS),
    any_config(units=64, rectangles=8, reflections=1, fraction_bits=8, patterns=True),
    any_config(units=16, rectangles=8, reflections=2, **LOOKS, culling=False),
    slow=[
        "seed-tiny48-u16", "seed-vga240-u16-r8-m1-f0t-d2-c8-materials", "seed-vga240-u16-r8-m2-f0t-d2-c8-k0",
        "seed-vga240-u32-r8-m1-f0t-d1-c8", "seed-vga240-u320", "seed-vga240-u40", "seed-vga240-u5",
    ],
    quick=["seed-vga240-u16-r8-m2-f0t-d2-c8-k0-materials-patterns"],
)  # fmt: skip
def test_ray_unit(config, leaf_of, random):
    check_ray_unit(leaf_of(ray_unit, config), config, random, rays=120 if config.fraction_bits == 0 else 40)
