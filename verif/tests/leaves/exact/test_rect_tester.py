# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_tester`."""

from itertools import chain, product

import numpy as np
from hard_scenes import sharpened, verdict
from vectors import LAST, by_axis, by_reflections, by_turn, exact_config, named, slope_inputs

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.world import Rectangles
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.rect_tester import rect_tester
from raycaster.verif.expected import sorted_rect
from raycaster.verif.random_world import EXTREMES, random_camera, random_rectangles

LATENCY = 3


def mirrored_rays(random: np.random.Generator, config: Configuration, count: int):
    """Yield tables, indices of rectangles to test, eyes, slopes and mirrors.

    They are as the engine meets them, and as extreme as its widths allow.
    """
    reflections, steepest = config.most_reflections, (1 << exact_slope_bits(config)) - 1
    for _ in range(count):
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
        yield table, set(chosen.tolist()), eye, slope, mirror


def extreme_rays(config: Configuration):
    """Yield the same for the furthest images of a camera and the steepest slopes, whose products need every bit."""
    far, steepest = LAST * (config.most_reflections + 1), (1 << exact_slope_bits(config)) - 1
    corners = np.array([[[0, 0, 0], [0, LAST, LAST]], [[0, 0, 0], [LAST, 0, LAST]], [[0, 0, LAST], [LAST, LAST, LAST]]])
    table = Rectangles(corners, np.zeros((3, 3), dtype=np.uint8), np.ones(3, dtype=bool))
    for place in (far, LAST - far):
        for other in (far, LAST - far, 0):
            for sign in (1, -1):
                for axis in range(3):
                    eye, slope = np.full(3, other), np.full(3, sign * steepest)
                    eye[axis], slope[axis] = place, -steepest if place > 0 else steepest
                    yield table, range(3), eye, slope, None
    # Planes close to the last mirror's, where a wrong bit of either distance matters.
    for axis, away in product(range(3) if config.most_reflections else (), (-33, -9, -1, 0, 1, 9, 33)):
        near = corners.copy()
        near[axis, :, axis] = WORLD_SIZE // 2 + away
        walls = Rectangles(near, np.zeros((3, 3), dtype=np.uint8), np.ones(3, dtype=bool))
        yield walls, range(3), np.full(3, LAST - far), np.full(3, steepest), (axis, WORLD_SIZE // 2)


@by_turn
@by_reflections
def test_rect_tester(reflections, turn, leaf_of, random):
    """The hit and its t; after two mirrors in one point, also hits in that point and at_mirror."""
    config = exact_config(reflections=reflections, turn=turn)
    leaf = leaf_of(rect_tester, config)
    distance, seen, corners = 0, set(), set()
    rays = mirrored_rays(random, config, leaf.some(1500))
    for table, chosen, eye, slope, mirror in chain(rays, extreme_rays(config)):
        met = {mirror[0]} if mirror else set()
        if mirror and reflections > 1 and random.random() < 0.5:
            met |= set(random.choice(3, int(random.integers(3))).tolist())
        ray = by_axis("eye_", eye) | slope_inputs(slope) | by_axis("mirror_met_", (axis in met for axis in range(3)))
        for index in chosen:
            started = int(not leaf.stimulus or random.random() < 0.9)
            mirrors = {"active": mirror is not None, "axis": mirror[0] if mirror else int(random.integers(3))}
            mirrors["distance"] = distance
            inputs = ray | sorted_rect(table, index, "rect") | named("mirror", mirrors)
            leaf.case({**inputs, "steps_find_intersection": started})
            # The mirror distance is read a cycle after all other inputs.
            distance = abs(int(mirror[1] - eye[mirror[0]])) if mirror else int(random.integers(WORLD_SIZE))
            hit, n, e, at_mirror = verdict(table, index, eye, slope, mirror, met)
            leaf.expect({"hit": hit}, when=started)
            leaf.expect({"numerator": n, "denominator": e, "at_mirror": at_mirror}, when=started and hit)
            if started:
                corners.add(at_mirror)
                seen.add((hit, int(table.axes[index]), mirror is not None))
    assert len(seen) == (12 if reflections else 6), "hits and misses on each axis, with a mirror and without"
    assert corners == {False, reflections > 0}, "hits in the mirror's plane and beyond it"
    idle = {"mirror_distance": distance, "steps_find_intersection": 0}
    leaf.stimulus += [idle] * LATENCY
    leaf.check(LATENCY, spare=True)


@by_turn
@by_reflections
def test_the_widths_are_just_wide_enough(reflections, turn):
    """The furthest image of a camera and its greatest products need every bit."""
    far = LAST * (reflections + 1)
    assert eye_bits(exact_config(reflections=reflections, turn=turn)) == far.bit_length() + 1
    greatest = far * (450 * 512 if turn else 190)
    assert greatest.bit_length() == (27, 28, 29)[reflections] if turn else (17, 18, 19)[reflections]
