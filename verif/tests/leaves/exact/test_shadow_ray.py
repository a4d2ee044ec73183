# SPDX-License-Identifier: MIT
"""Leaf tests of `shadow_ray`: the ray from the light, compared with the image contract's formulas."""

import numpy as np
import pytest
from vectors import LAST, ports

from raycaster.configuration import WORLD_SIZE, configure
from raycaster.golden.random_world import EXTREMES
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Eye, Slope, Steps
from raycaster.rtl.common.records import Signs, camera_of, surface_of
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits, light_slope_bits
from raycaster.rtl.exact.shadow_ray import shadow_ray

CASES = 200


@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
@pytest.mark.parametrize("reflections", [0, 2, 4])
def test_shadow_ray(reflections, turn, tmp_path, random):
    """S = N - e L and the side of the light, for points at the world's corners, on its planes and anywhere."""
    config = configure(engine="exact", reflections=reflections, turn=turn, light=True, allow_underrun=True)
    slope_bits, eyes = exact_slope_bits(config), eye_bits(config)
    leaf = Leaf(
        shadow_ray,
        lambda: ports(
            "clk facing",
            steps=Steps(),
            camera=camera_of(config),
            eye=Eye(eyes),
            signs=Signs(),
            slope=Slope(slope_bits),
            found_surface=surface_of(config),
            found_distance=unsigned(eyes - 1),
            found_slope=unsigned(slope_bits),
            shadow_signs=Signs(),
            shadow_slope=Slope(light_slope_bits(config)),
        ),
        tmp_path,
    )
    far, steepest = LAST * (reflections + 1), (1 << slope_bits) - 1
    if not turn:
        steepest = 190
    stimulus, expected, sides = [], [], set()
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
        for name, value, component in zip("xyz", eye.tolist(), slope.tolist(), strict=True):
            held |= {f"eye_{name}": value % (1 << eyes), f"slope_d{name}": abs(component)}
            held[f"signs_d{name}"] = int(component < 0)
        held |= {f"camera_light_{name}": int(value) for name, value in zip("xyz", light, strict=True)}
        stimulus += [{**held, "steps_aim": 1 << cycle >> 1} for cycle in range(5)] + [{**held, "steps_aim": 0}]
        shadow = numerators - e * light
        wanted = {f"shadow_slope_d{name}": abs(int(part)) for name, part in zip("xyz", shadow, strict=True)}
        wanted |= {f"shadow_signs_d{name}": int(part < 0) for name, part in zip("xyz", shadow, strict=True)}
        wanted["facing"] = int((light[axis] - plane) * -slope[axis] > 0)
        expected.append((len(stimulus) - 1, wanted))
        sides.add((wanted["facing"], int(np.sign(light[axis] - plane)), axis))
    outputs = leaf.run_both(stimulus, settled=6)
    for cycle, wanted in expected:
        assert {name: outputs[cycle][name] for name in wanted} == wanted, stimulus[cycle]
    assert len(sides) == 15
