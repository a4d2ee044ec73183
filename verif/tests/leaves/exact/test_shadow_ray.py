# SPDX-License-Identifier: MIT
"""Leaf tests of `shadow_ray`: the ray from the light, compared with the image contract's formulas."""

import numpy as np
import pytest
from exact_vectors import exact_config
from vectors import LAST, by_axis, check, leaf_of, named, slope_inputs

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.random_world import EXTREMES
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.records import Signs, surface_of
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits, light_slope_bits
from raycaster.rtl.exact.shadow_ray import shadow_ray

CASES = 200


@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
@pytest.mark.parametrize("reflections", [0, 2, 4])
def test_shadow_ray(reflections, turn, tmp_path, random):
    """S = N - e L and the side of the light, for points at the world's corners, on its planes and anywhere."""
    config = exact_config(reflections=reflections, turn=turn, light=True)
    slope_bits, eyes = exact_slope_bits(config), eye_bits(config)
    shadow = {"shadow_signs": Signs, "shadow_slope": lambda: Slope(light_slope_bits(config))}
    found = {"found_surface": lambda: surface_of(config), "found_distance": eyes - 1, "found_slope": slope_bits}
    leaf = leaf_of(shadow_ray, tmp_path, config, **shadow, **found)
    far, steepest = LAST * (reflections + 1), (1 << slope_bits) - 1 if turn else 190
    stimulus, expected, sides = [], {}, set()
    while len(expected) < CASES:
        # A ray that is inside the world at n / e, often close to a corner or a border of it.
        axis = int(random.integers(3))
        point = np.where(random.random(3) < 0.5, random.choice(EXTREMES, 3), random.integers(WORLD_SIZE, size=3))
        n = int(random.choice([1, 2, 8, LAST, far, random.integers(1, far + 1)]))
        e = int(random.choice([1, 2, n, 2 * n, steepest, random.integers(1, steepest + 1)]))
        slope = random.integers(-steepest, steepest + 1, 3)
        slope[axis] = e * random.choice([-1, 1])
        eye = np.zeros(3, dtype=np.int64)
        for other in range(3):
            # The point is between whole coordinates if e does not divide slope * n.
            eye[other] = point[other] - int(slope[other]) * n // e
        numerators = eye * e + slope * n
        inside = (numerators >= 0).all() and (numerators <= LAST * e).all()
        if e > steepest or not inside or eye.min() < -LAST * reflections or eye.max() > far:
            continue
        plane = int(numerators[axis]) // e
        light = np.where(random.random(3) < 0.4, random.choice(EXTREMES, 3), random.integers(WORLD_SIZE, size=3))
        if random.random() < 0.3:
            light[axis] = np.clip(plane + random.integers(-1, 2), 0, LAST)
        held = {"found_surface_axis": axis, "found_surface_position": plane, "found_distance": n, "found_slope": e}
        held |= by_axis("eye_", eye) | slope_inputs(slope) | by_axis("camera_light_", light)
        stimulus += [{**held, "steps_aim": 1 << cycle >> 1} for cycle in range(5)] + [{**held, "steps_aim": 0}]
        facing = int((light[axis] - plane) * -slope[axis] > 0)
        shadow_slope = slope_inputs(numerators - e * light)
        expected[len(stimulus) - 1] = named("shadow", shadow_slope) | {"facing": facing}
        sides.add((facing, int(np.sign(light[axis] - plane)), axis))
    check(leaf, stimulus, expected, settled=6)
    assert len(sides) == 15
