# SPDX-License-Identifier: MIT
"""Leaf tests of the exact engine's blocks that make rays and mirror them."""

import numpy as np
from vectors import LAST, basis_inputs, by, by_axis, by_reflections, designs, exact_config, slope_inputs

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.signals import Signed, bit, unconnected
from raycaster.rtl.common.interfaces import Slope, Vector
from raycaster.rtl.common.records import Signs
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits, light_slope_bits
from raycaster.rtl.exact.eye_register import Mirror, eye_register
from raycaster.rtl.exact.ray_switch import ray_switch
from raycaster.rtl.exact.slope_component import slope_component
from raycaster.rtl.exact.turned_generator import turned_generator
from raycaster.verif.random_world import random_basis


def test_slope_component(leaf_of, random):
    """Random bases and places; a place that is not loaded changes nothing."""
    config = exact_config(turn=True, units=8)
    screen = config.screen_geometry
    widths = dict.fromkeys(("forward", "right", "up", "column", "row"), Signed(10))
    leaf = leaf_of(slope_component, config, **widths, size=exact_slope_bits(config))
    component = 0
    for _ in range(1000):
        forward, right, up = (int(value) for value in random_basis(random)[0])
        column = int(random.choice([0, screen.columns - config.units, random.integers(screen.columns)]))
        row = int(random.choice([0, screen.rows - 1, random.integers(screen.rows)]))
        given = {"column": column - screen.centre_column, "row": screen.horizon_row - row}
        given |= {"column_base": int(random.integers(config.units)), "forward": forward, "right": right, "up": up}
        load = int(not leaf.stimulus or random.random() < 0.8)
        for strobe in (0, load):
            leaf.case({**given, "steps_screen_to_ray": strobe}, {"size": abs(component), "negative": component < 0})
        if load:
            across = given["column"] + given["column_base"]
            component = screen.view_distance * forward + across * right + given["row"] * up
    leaf.case({"steps_screen_to_ray": 0}, {"size": abs(component), "negative": component < 0})
    leaf.check(settled=2)


@designs(*(exact_config(turn=True, units=n, screen=screen) for n, screen in ((4, "vga"), (5, "vga"), (2, "tiny"))))
def test_turned_generator(config, leaf_of, random):
    """Place and camera come a cycle before the ray is loaded; without a load, nothing changes."""
    leaf, screen, shown = leaf_of(turned_generator, config), config.screen_geometry, None
    for number in range(500):
        basis = random_basis(random)
        row = int(random.choice([0, screen.horizon_row, screen.rows - 1, random.integers(screen.rows)]))
        column = int(random.choice([0, screen.centre_column, screen.columns - 1, random.integers(screen.columns)]))
        load = int(number == 0 or random.random() < 0.8)
        held = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        held |= basis_inputs(basis)
        for strobe in (0, load):
            leaf.case({**held, "steps_screen_to_ray": strobe}, shown)
        if load:
            place = [screen.view_distance, column - screen.centre_column, screen.horizon_row - row]
            shown = slope_inputs(np.array(place) @ np.array(basis), "initial_signs")
    # The counters stop one past their last value, where nothing may overflow.
    leaf.case({**held, "place_row": screen.rows, "place_column_offset": config.groups}, shown)
    leaf.check(settled=2)


@by_reflections
def test_eye_register(reflections, leaf_of, random):
    """The camera, then its image in one mirror after the other; the mirrors met in the ray's last point."""
    config = exact_config(reflections=reflections)
    at_mirror = bit if reflections > 1 else lambda: unconnected(1)
    leaf = leaf_of(eye_register, config, found_at_mirror=at_mirror)
    leaf.stimulus += [{"steps_screen_to_ray": 1}, {"steps_screen_to_ray": 0, "steps_store_ray": 1}]
    for _ in range(400):
        camera = random.choice([0, LAST, int(random.integers(WORLD_SIZE))], 3)
        initial = random.integers(2, size=3)
        leaf.case({**by_axis("camera_", camera), "steps_screen_to_ray": 1, "steps_store_ray": 0}, None)
        eye, signs, mirror, met, distance = camera.tolist(), initial.tolist(), None, set(), 0
        for bounce in range(reflections + 1):
            for _ in range(int(random.integers(1, 3))):
                axis, plane = int(random.integers(3)), int(random.choice([0, LAST, random.integers(WORLD_SIZE)]))
                if mirror is not None and random.random() < 0.5:
                    # Mirrors on opposite sides of the world move the image as far away as possible.
                    axis, plane = mirror[0], LAST - mirror[1]
                surface = {"found_surface_axis": axis, "found_surface_position": plane}
                surface |= {"found_distance": abs(plane - eye[axis])}
                noise = by_axis("camera_", random.integers(WORLD_SIZE, size=3)) | by_axis("initial_signs_d", initial)
                noise |= {"found_at_mirror": random.integers(2)} if reflections > 1 else {}
                leaf.case({**noise, **surface, "steps_screen_to_ray": 0, "steps_store_ray": 0})
                leaf.expect(by_axis("eye_", eye) | by_axis("signs_d", signs) | {"mirror_active": mirror is not None})
                leaf.expect({"mirror_axis": mirror and mirror[0], "mirror_distance": distance}, when=mirror)
                leaf.expect(by_axis("mirror_met_", (place in met for place in range(3))), when=reflections > 1)
            if bounce < reflections:
                leaf.stimulus[-1]["steps_store_ray"] = 1
                eye[axis], signs[axis], mirror = 2 * plane - eye[axis], not signs[axis], (axis, plane)
                distance = abs(plane - eye[axis])
                met = met | {axis} if leaf.stimulus[-1].get("found_at_mirror") else {axis}
    leaf.check(settled=2, spare=True)


PARTS = [f"{record}_d{axis}" for record in ("signs", "slope") for axis in "xyz"]
"""Fields that both rays have."""


@by(reflections=[1, 2])
def test_ray_switch(reflections, leaf_of, random):
    """All fields of one ray or of the other; the shadow ray has left no mirror."""
    config = exact_config(reflections=reflections, light=True)
    slopes = dict.fromkeys(("shadow_slope", "tested_slope"), lambda: Slope(light_slope_bits(config)))
    tested = {"tested_eye": lambda: Vector(eye_bits(config)), "tested_mirror": lambda: Mirror(config)}
    leaf = leaf_of(ray_switch, config, **slopes, **tested, shadow_signs=Signs, tested_signs=Signs)
    mirror = [name for name in leaf.given if name.startswith("mirror_")]
    for _ in range(200):
        inputs = {name: int(random.integers(1 << member.width)) for name, member in leaf.given.items()}
        if inputs["from_light"]:
            wanted = {f"tested_eye_{axis}": inputs[f"camera_light_{axis}"] for axis in "xyz"}
            wanted |= {f"tested_{part}": inputs[f"shadow_{part}"] for part in PARTS} | {"tested_mirror_active": 0}
        else:
            own = [f"eye_{axis}" for axis in "xyz"] + PARTS + mirror
            wanted = {f"tested_{name}": inputs[name] for name in own}
        leaf.case(inputs, wanted)
    leaf.check()
