# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_unit`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from engine_vectors import check_ray_unit, ray_unit_leaf
from vectors import any_config, config_id


@pytest.mark.slow_sets(
    "seed-tiny48-u16",
    "seed-vga240-u16-r8-m1-f0t-d2-c8-materials",
    "seed-vga240-u16-r8-m2-f0t-d2-c8-k0",
    "seed-vga240-u32-r8-m1-f0t-d1-c8",
    "seed-vga240-u320",
    "seed-vga240-u40",
    "seed-vga240-u5",
    quick=["seed-vga240-u16-r8-m2-f0t-d2-c8-k0-materials-patterns"],
)
@pytest.mark.parametrize(
    "config",
    [
        any_config(
            screen=screen, units=units, rectangles=rectangles, reflections=reflections, fraction_bits=bits,
            rounding=rounding, divider_bits=divider_bits, colour_bits=colour_bits,
        )
        for screen, units, rectangles, reflections, bits, rounding, divider_bits, colour_bits in (
            ("vga", 32, 8, 1, 0, "truncate", 1, 8), ("vga", 5, 8, 2, 0, "nearest", 3, 4),
            ("tiny", 2, 3, 0, 0, "truncate", 2, 8), ("vga", 1, 8, 2, 1, "truncate", 2, 5),
            ("vga", 320, 7, 2, 4, "nearest", 3, 8), ("vga", 64, 8, 1, 4, "truncate", 1, 1),
            ("tiny", 16, 8, 2, 8, "nearest", 2, 8), ("vga", 40, 8, 2, 8, "truncate", 3, 8),
        )
    ]
    + [any_config(units=16, rectangles=8, reflections=2, culling=False)]
    + [
        any_config(units=units, rectangles=8, reflections=reflections, fraction_bits=bits, **options)
        for units, reflections, bits, options in (
            (16, 1, 0, {"materials": True}), (32, 2, 3, {"materials": True, "patterns": True}),
            (64, 1, 8, {"patterns": True}), (16, 2, 0, {"materials": True, "patterns": True, "culling": False}),
        )
    ],
    ids=config_id,
)  # fmt: skip
def test_ray_unit(config, tmp_path, random):
    check_ray_unit(ray_unit_leaf(config, tmp_path), config, random, rays=120 if config.fraction_bits == 0 else 40)
