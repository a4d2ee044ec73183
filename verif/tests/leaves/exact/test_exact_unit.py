# SPDX-License-Identifier: MIT
"""Leaf test of `exact_unit`."""

from engine_vectors import check_ray_unit
from vectors import designs, exact_config

from raycaster.rtl.exact.exact_unit import exact_unit

ALL = {"turn": True, "materials": True, "patterns": True}


@designs(
    exact_config(units=4, rectangles=8, reflections=1),
    exact_config(units=5, rectangles=8, reflections=2),
    exact_config(screen="tiny", units=2, rectangles=8, reflections=0, colour_bits=1),
    exact_config(units=320, rectangles=8, reflections=2, colour_bits=4),
    exact_config(units=1, rectangles=4, reflections=2),
    exact_config(units=8, rectangles=8, reflections=4),
    exact_config(units=8, rectangles=8, reflections=2, culling=True),
    exact_config(units=4, rectangles=8, reflections=1, turn=True),
    exact_config(units=8, rectangles=8, reflections=2, turn=True),
    exact_config(units=5, rectangles=8, reflections=1, patterns=True),
    exact_config(units=8, rectangles=8, reflections=2, materials=True),
    exact_config(units=5, rectangles=8, reflections=2, **ALL),
    exact_config(units=8, rectangles=8, reflections=4, **ALL),
    exact_config(units=4, rectangles=8, reflections=0, **ALL),
    slow=["exact-vga240-u1-", "exact-vga240-u5"],
)
def test_exact_unit(config, leaf_of, random):
    rays = 500 if config == exact_config(units=5, rectangles=8, reflections=2) else 80
    check_ray_unit(leaf_of(exact_unit, config), config, random, rays)
