# SPDX-License-Identifier: MIT
"""Leaf tests of `eye_register`: MyHDL and converted Verilog match the expected values on the same vectors."""

from exact_vectors import by_reflections, exact_config, two_complement
from vectors import AXES, LAST, ports

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unconnected, unsigned
from raycaster.rtl.common.interfaces import Eye, Steps
from raycaster.rtl.common.records import Point, Signs, Surface, mirror_of
from raycaster.rtl.common.widths import eye_bits
from raycaster.rtl.exact.eye_register import eye_register


@by_reflections
def test_eye_register(reflections, tmp_path, random):
    config = exact_config(reflections=reflections)
    leaf = Leaf(eye_register, lambda: ports(
        "clk", steps=Steps(), camera=Point(), initial_signs=Signs(), found_surface=Surface(),
        found_distance=unsigned(eye_bits(config) - 1), found_at_mirror=bit() if reflections > 1 else unconnected(1),
        eye=Eye(eye_bits(config)), signs=Signs(), mirror=mirror_of(config)
    ), tmp_path)  # fmt: skip
    stimulus, expected = [{"steps_screen_to_ray": 1}, {"steps_screen_to_ray": 0, "steps_store_ray": 1}], [None, None]
    for _ in range(400):
        camera = random.choice([0, LAST, int(random.integers(WORLD_SIZE))], 3)
        initial = random.integers(2, size=3)
        sight = {f"initial_signs_d{axis}": int(value) for axis, value in zip(AXES, initial, strict=True)}
        stimulus.append({**two_complement(camera, 9, "camera"), "steps_screen_to_ray": 1, "steps_store_ray": 0})
        expected.append(None)
        eye, signs, mirror = [int(value) for value in camera], [bool(value) for value in initial], None
        met, distance = set(), 0
        for bounce in range(reflections + 1):
            for _ in range(int(random.integers(1, 3))):
                axis, plane = int(random.integers(3)), int(random.choice([0, LAST, random.integers(WORLD_SIZE)]))
                if mirror is not None and random.random() < 0.5:
                    # Mirrors on opposite sides of the world move the image as far away as possible.
                    axis, plane = mirror[0], LAST - mirror[1]
                surface = {"found_surface_axis": axis, "found_surface_position": plane}
                surface |= {"found_distance": abs(plane - eye[axis])}
                noise = two_complement(random.integers(WORLD_SIZE, size=3), 9, "camera")
                stimulus.append({**noise, **sight, **surface, "steps_screen_to_ray": 0, "steps_store_ray": 0})
                if reflections > 1:
                    stimulus[-1]["found_at_mirror"] = int(random.integers(2))
                expected.append((list(eye), list(signs), mirror and (mirror[0], distance), set(met)))
            if bounce < reflections:
                stimulus[-1]["steps_store_ray"] = 1
                eye[axis], signs[axis], mirror = 2 * plane - eye[axis], not signs[axis], (axis, plane)
                distance = abs(plane - eye[axis])
                met = met | {axis} if stimulus[-1].get("found_at_mirror") else {axis}
    outputs = leaf.run_both(stimulus, settled=2)
    bits = eye_bits(config)
    for cycle, wanted in enumerate(expected):
        if wanted is None:
            continue
        eye, signs, mirror, met = wanted
        output = outputs[cycle]
        assert {name: output[name] for name in two_complement(eye, bits, "eye")} == two_complement(eye, bits, "eye")
        assert [bool(output[f"signs_d{axis}"]) for axis in AXES] == signs
        assert bool(output["mirror_active"]) == (mirror is not None)
        if mirror is not None:
            assert (output["mirror_axis"], output["mirror_distance"]) == mirror
        if reflections > 1:
            assert {place for place, axis in enumerate(AXES) if output[f"mirror_met_{axis}"]} == met
