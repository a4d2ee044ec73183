# SPDX-License-Identifier: MIT
"""`shadow_ray`: S = N - e L and the side of the light, for points at the world's corners, on planes and anywhere."""

import numpy as np
import pytest
from vectors import LAST, by_axis, exact_config, named, slope_inputs

from raycaster.configuration import WORLD_SIZE
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.common.records import Signs
from raycaster.rtl.common.widths import exact_slope_bits, light_slope_bits
from raycaster.rtl.exact.shadow_ray import shadow_ray
from raycaster.verif.random_world import EXTREMES

CASES = 200


@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
@pytest.mark.parametrize("reflections", [0, 2, 4])
def test_shadow_ray(reflections, turn, leaf_of, random):
    config = exact_config(reflections=reflections, turn=turn, light=True)
    shadow = {"shadow_signs": Signs, "shadow_slope": lambda: Slope(light_slope_bits(config))}
    leaf = leaf_of(shadow_ray, config, **shadow)
    far, steepest = LAST * (reflections + 1), (1 << exact_slope_bits(config)) - 1 if turn else 190
    sides = set()
    while len(leaf.expected) < CASES:
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
        leaf.stimulus += [{**held, "steps_aim": 1 << cycle >> 1} for cycle in range(5)] + [{**held, "steps_aim": 0}]
        facing = int((light[axis] - plane) * -slope[axis] > 0)
        leaf.expect(named("shadow", slope_inputs(numerators - e * light)) | {"facing": facing})
        sides.add((facing, int(np.sign(light[axis] - plane)), axis))
    leaf.check(settled=6)
    assert len(sides) == 15
