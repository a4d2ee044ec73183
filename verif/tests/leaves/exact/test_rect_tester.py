# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

from fractions import Fraction

import numpy as np
from exact_vectors import by_reflections, by_turn, exact_config, slope_inputs, two_complement
from hard_scenes import sharpened, verdict
from vectors import AXES, LAST, ports

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.random_world import EXTREMES, random_camera, random_rectangles
from raycaster.golden.world import Rectangles
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Eye, Slope, Steps
from raycaster.rtl.common.records import Rect, Signs, mirror_of
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.verif.expected import sorted_rect

LATENCY = 3


def leaf_of_tester(config: Configuration, directory) -> Leaf:
    return Leaf(rect_tester, lambda: ports(
        "clk hit at_mirror", steps=Steps(), rect=Rect(), eye=Eye(eye_bits(config)), signs=Signs(),
        slope=Slope(exact_slope_bits(config)), mirror=mirror_of(config), numerator=unsigned(eye_bits(config) - 1),
        denominator=unsigned(exact_slope_bits(config))
    ), directory)  # fmt: skip


def mirror_time(eye, slope, mirror) -> Fraction:
    """Compute t of the mirror that the ray left last."""
    axis, position = mirror
    return Fraction(int(position - eye[axis]), int(slope[axis]))


def mirrored_rays(random: np.random.Generator, config: Configuration, count: int):
    """Yield tables, indices of rectangles to test, eyes, slopes and mirrors.

    They are as the engine meets them, and as extreme as its widths allow.
    """
    reflections, steepest = config.reflections, (1 << exact_slope_bits(config)) - 1
    while count > 0:
        table = random_rectangles(random, count=8, closed=True)
        eye = random_camera(random, table).astype(np.int64)
        steep = random.choice([0, 1, 2, 99, 100, 160, 190, steepest, int(random.integers(steepest))], 3)
        # Equal slopes lead to points with whole coordinates.
        slope = (steep if random.random() < 0.6 else steep[[0, 0, 0]]) * random.choice([-1, 1], 3)
        mirror = None
        for _ in range(int(random.integers(reflections + 1))):
            axis = int(random.integers(3))
            slope[axis] = slope[axis] or 1
            plane = int(random.choice([random.choice(EXTREMES), random.integers(WORLD_SIZE)]))
            if mirror is not None and random.random() < 0.5:
                # Mirrors on opposite sides of the world move the image as far away as possible.
                axis, plane = mirror[0], LAST - mirror[1]
            if plane != eye[axis]:
                # A mirror is always ahead of the eye, even of a mirrored one.
                slope[axis] = abs(slope[axis]) * (1 if eye[axis] < plane else -1)
                eye[axis], slope[axis], mirror = 2 * plane - eye[axis], -slope[axis], (axis, plane)
        chosen = random.choice(np.flatnonzero(table.visible), 4)
        for index in chosen:
            table = sharpened(random, table, int(index), eye, slope, mirror)
        count -= 1
        yield table, set(chosen.tolist()), eye, slope, mirror


@by_turn
@by_reflections
def test_rect_tester(reflections, turn, tmp_path, random):
    """The hit and its t; after two mirrors in one point, also hits in that point and at_mirror."""
    config = exact_config(reflections=reflections, turn=turn)
    leaf = leaf_of_tester(config, tmp_path)
    stimulus, expected, distance = [], [], 0
    for table, chosen, eye, slope, mirror in mirrored_rays(random, config, 1500):
        met = {mirror[0]} if mirror else set()
        if mirror and reflections > 1 and random.random() < 0.5:
            met |= set(random.choice(3, int(random.integers(3))).tolist())
        mask = {f"mirror_met_{axis}": int(place in met) for place, axis in enumerate(AXES)}
        for index in chosen:
            started = int(not stimulus or random.random() < 0.9)
            stimulus.append(
                {
                    **sorted_rect(table, index, "rect"), **two_complement(eye, eye_bits(config), "eye"),
                    **{name: value for name, value in mask.items() if name in leaf.given},
                    **slope_inputs(slope), "mirror_active": int(mirror is not None),
                    "mirror_axis": mirror[0] if mirror else int(random.integers(3)),
                    "mirror_distance": distance, "steps_find_intersection": started,
                }
            )  # fmt: skip
            # The mirror distance is read a cycle after all other inputs.
            distance = abs(int(mirror[1] - eye[mirror[0]])) if mirror else int(random.integers(WORLD_SIZE))
            hit, n, e = verdict(table, index, eye, slope, mirror, met)
            meets = hit and mirror is not None and Fraction(n, e) == mirror_time(eye, slope, mirror)
            expected.append((hit, n, e, meets) if started else None)
    seen, corners = set(), set()
    stimulus += [{"mirror_distance": distance, "steps_find_intersection": 0}] * LATENCY
    outputs = leaf.run_both(stimulus, settled=LATENCY)
    for cycle, wanted in enumerate(expected):
        if wanted is None:
            continue
        output = outputs[cycle + LATENCY]
        assert bool(output["hit"]) == wanted[0], stimulus[cycle]
        if wanted[0]:
            assert (output["numerator"], output["denominator"]) == wanted[1:3], stimulus[cycle]
            assert bool(output["at_mirror"]) == wanted[3], stimulus[cycle]
        corners.add(wanted[3])
        seen.add((wanted[0], stimulus[cycle]["rect_axis"], stimulus[cycle]["mirror_active"]))
    assert len(seen) == (12 if reflections else 6), "hits and misses on each axis, with a mirror and without"
    assert corners == {False, reflections > 0}, "hits in the mirror's plane and beyond it"


@by_turn
@by_reflections
def test_the_widths_are_just_wide_enough(reflections, turn, tmp_path):
    """The furthest image of a camera and its greatest products need every bit."""
    config = exact_config(reflections=reflections, turn=turn)
    far = LAST * (reflections + 1)
    assert eye_bits(config) == far.bit_length() + 1
    greatest = far * (450 * 512 if turn else 190)
    assert greatest.bit_length() == (27, 28, 29)[reflections] if turn else (17, 18, 19)[reflections]
    leaf = leaf_of_tester(config, tmp_path)
    steepest = (1 << exact_slope_bits(config)) - 1
    corners = np.array([[[0, 0, 0], [0, LAST, LAST]], [[0, 0, 0], [LAST, 0, LAST]], [[0, 0, LAST], [LAST, LAST, LAST]]])
    table = Rectangles(corners, np.zeros((3, 3), dtype=np.uint8), np.ones(3, dtype=bool))
    stimulus, expected = [], []
    for place in (far, -LAST * reflections):
        for other in (far, -LAST * reflections, 0):
            for sign in (1, -1):
                for axis in range(3):
                    eye = [other] * 3
                    eye[axis] = place
                    slope = [sign * steepest] * 3
                    slope[axis] = -steepest if place > 0 else steepest
                    for index in range(3):
                        rect = sorted_rect(table, index, "rect")
                        eyes = two_complement(eye, eye_bits(config), "eye")
                        stimulus.append({**rect, **eyes, **slope_inputs(slope), "steps_find_intersection": 1})
                        expected.append(verdict(table, index, eye, slope, None))
    outputs = leaf.run_both([*stimulus, *[{}] * LATENCY], settled=LATENCY)
    for cycle, wanted in enumerate(expected):
        assert bool(outputs[cycle + LATENCY]["hit"]) == wanted[0], stimulus[cycle]
        if wanted[0]:
            assert (outputs[cycle + LATENCY]["numerator"], outputs[cycle + LATENCY]["denominator"]) == wanted[1:]
    assert any(wanted[0] for wanted in expected)
