# SPDX-License-Identifier: MIT
"""`eye_register`: the camera, then its image in one mirror after the other; the mirrors met in the ray's last point."""

from vectors import LAST, by_axis, by_reflections, exact_config

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.signals import bit, unconnected
from raycaster.rtl.exact.eye_register import eye_register


@by_reflections
def test_eye_register(reflections, leaf_of, random):
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
