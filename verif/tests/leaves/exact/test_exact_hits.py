# SPDX-License-Identifier: MIT
"""Leaf tests of the exact engine's blocks that find hits, the nearest hit and its cell."""

from fractions import Fraction
from itertools import chain, product
from math import gcd

import numpy as np
import pytest
from hard_scenes import sharpened, verdict
from vectors import LAST, by_axis, by_reflections, by_turn, exact_config, named, slope_inputs

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.cell_finder import cell_finder
from raycaster.rtl.exact.extent_tester import extent_tester
from raycaster.rtl.exact.hit_component import hit_component
from raycaster.rtl.exact.nearest_hit import nearest_hit
from raycaster.rtl.exact.rect_tester import LATENCY, rect_tester
from raycaster.verif.expected import sorted_rect
from raycaster.verif.random_world import EXTREMES, random_camera, random_rectangles


@pytest.mark.parametrize(
    ("eye_bits", "slope_bits", "bits"), [(10, 8, 17), (12, 18, 28)], ids=["narrow", "as wide as its result"]
)
def test_hit_component(eye_bits, slope_bits, bits, leaf_of, random):
    """The lowest bits of E e + D n, for combinations of operands at their limits, and for random ones."""
    widths = {"eye": Signed(eye_bits), "slope": slope_bits, "distance": eye_bits - 1, "e": slope_bits}
    leaf = leaf_of(hit_component, **widths, component=bits)
    most, steepest = (1 << (eye_bits - 1)) - 1, (1 << slope_bits) - 1
    cases = list(product((-most - 1, -1, 0, 1, most), (0, 1), (0, 1, steepest), (0, 1, most), (0, 1, steepest)))
    limits = ((-most - 1, most), (0, 1), (0, steepest), (0, most), (0, steepest))
    cases += [tuple(int(random.integers(low, high + 1)) for low, high in limits) for _ in range(300)]
    for case in cases:
        eye, back, slope, distance, e = case
        inputs = dict(zip(("eye", "back", "slope", "distance", "e"), case, strict=True))
        leaf.case(inputs, {"component": (eye * e + (-slope if back else slope) * distance) % (1 << bits)})
    leaf.check()


@by_reflections
def test_extent_tester(reflections, leaf_of, random):
    """Rays that meet the plane before, at and beyond the bounds and the mirror, by fractions."""
    config = exact_config(reflections=reflections)
    eye_width, slope_bits = eye_bits(config), exact_slope_bits(config)
    widths = {"low": 9, "high": 9, "eye": Signed(eye_width), "slope": slope_bits}
    widths |= {"mirror_distance": eye_width - 1, "n": eye_width - 1, "e": slope_bits}
    leaf, late, seen = leaf_of(extent_tester, **widths), {}, set()
    far, steepest = LAST * (reflections + 1), (1 << slope_bits) - 1
    for cycle in range(leaf.some(6000)):
        low, high = sorted(int(random.choice([0, 1, LAST, random.integers(WORLD_SIZE)])) for _ in range(2))
        eye = int(random.choice([0, LAST, far, far - LAST, LAST - far, random.integers(LAST - far, far + 1)]))
        eye = int(np.clip(eye, LAST - far, far))
        back, on_mirror = (int(value) for value in random.integers(2, size=2))
        slope, e = (int(random.choice([1, 2, steepest, random.integers(1, steepest + 1)])) for _ in range(2))
        near, beyond = (eye - high, eye - low) if back else (low - eye, high - eye)
        mirror = max(0, int(random.choice([near, near - 1, near + 1, beyond, beyond + 1, random.integers(far + 1)])))
        # Aim near one of the deciding places, if a product can reach it.
        goal = int(random.choice([near, beyond, mirror, random.integers(far + 1)]))
        n = goal * e // slope + int(random.integers(-1, 2))
        if goal * e % slope and random.random() < 0.5:
            e, n = slope, goal
        n = int(np.clip(n, 1, (1 << eye_width - 1) - 1))
        step = int(cycle == 0 or random.random() < 0.9)
        bounds = {"low": low, "high": high, "eye": eye, "back": back, "slope": slope}
        leaf.case({**late, **bounds, "step": step, "on_mirror": on_mirror}, {"ahead": beyond >= 0})
        mirror = min(mirror, (1 << eye_width - 1) - 1)
        late = {"mirror_distance": mirror, "n": n, "e": e}
        if step and beyond >= 0:
            at = Fraction(slope * n, e)
            behind_mirror = on_mirror and near <= mirror and at < mirror
            between, in_mirror = near <= at <= beyond and not behind_mirror, on_mirror and near <= mirror == at
            leaf.expected[cycle + 2] |= {"between": between, "in_mirror": in_mirror}
            seen |= {bool(between), bool(in_mirror)}
    assert seen == {False, True}
    leaf.stimulus += [late, {}]
    leaf.check(settled=2)


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


@by_turn
@by_reflections
def test_nearest_hit(reflections, turn, leaf_of, random):
    """Hits nearer than the nearest, as near in the same or other terms, and next to it."""
    config = exact_config(reflections=reflections, turn=turn)
    numerator_bits, denominator_bits = eye_bits(config) - 1, exact_slope_bits(config)
    leaf = leaf_of(nearest_hit, config)
    leaf.case({"steps_reset_z_buf": 1})
    best, kept, settled = None, {}, None
    for _ in range(leaf.some(12000)):
        reset, write, hit = (int(random.random() < chance) for chance in (0.1, 0.8, 0.6))
        factor = int(random.integers(1, 4))
        n, e = (
            int(random.choice([1, 2, 3, 100, random.integers(1, 1 << bits - 2), (1 << bits) - 1]))
            for bits in (numerator_bits, denominator_bits)
        )
        if best is not None and random.random() < 0.6:
            # As near as the nearest, with other terms.
            n, e = best.numerator * factor, best.denominator * factor
            if n >= 1 << numerator_bits or e >= 1 << denominator_bits:
                n, e = best.numerator, best.denominator
            if random.random() < 0.5:
                # Next to it, with another denominator.
                e = int(random.integers(1, 1 << denominator_bits))
                n = int(best * e)
            n = min(max(n + int(random.integers(-1, 2)), 1), (1 << numerator_bits) - 1)
        offered = {"axis": random.integers(3), "position": random.integers(512), "colour": random.integers(1 << 24)}
        at_mirror = random.integers(2)
        steps = {"steps_reset_z_buf": reset, "steps_write_z_buf": write}
        terms = {"numerator": n, "denominator": e, "at_mirror": at_mirror}
        leaf.case({**named("offered", offered), **steps, **terms, "hit": hit}, {"found": best is not None})
        leaf.expect(kept, when=best is not None)
        if reset:
            best = None
        elif write and hit and (best is None or Fraction(n, e) < best):
            best = Fraction(n, e)
            kept = named("found_surface", offered)
            kept |= {"found_distance": n, "found_slope": e, "found_at_mirror": at_mirror}
            settled = settled or leaf.cycle
    outputs = leaf.check(settled=settled)
    assert not any(output["found"] for output in outputs[1:settled])


@by_turn
@by_reflections
def test_cell_finder(reflections, turn, leaf_of, random):
    """Cells of points, computed with fractions: cells of every size, and points on cell borders."""
    config = exact_config(reflections=reflections, turn=turn, patterns=True)
    leaf, borders = leaf_of(cell_finder, config), 0
    far, steepest = LAST * (reflections + 1), (1 << exact_slope_bits(config)) - 1
    while len(leaf.expected) < 300:
        axis, size = int(random.integers(3)), int(random.integers(8))
        n = int(random.choice([1, 8, far, random.integers(1, far + 1)]))
        e = int(random.choice([1, 2, min(n, steepest), steepest, random.integers(1, steepest + 1)]))
        eye, slope = random.integers(WORLD_SIZE, size=3), random.integers(-steepest, steepest + 1, 3)
        for q in OTHER_AXES[axis]:
            # A whole coordinate, at a cell border or elsewhere, and slopes that hit it or miss it by the least amount.
            place = int(random.choice([8 * random.integers(64), random.integers(WORLD_SIZE)]))
            times = int(random.integers(-4, 5))
            slope[q] = times * (e // gcd(n, e)) + int(random.choice([-1, 0, 0, 1]))
            eye[q] = place - times * (n // gcd(n, e))
        point = [int(eye[q]) + Fraction(int(slope[q]) * n, e) for q in OTHER_AXES[axis]]
        if not all(0 <= place <= LAST for place in point) or abs(slope).max() > steepest:
            continue
        if eye.min() < -LAST * reflections or eye.max() > far:
            continue
        cells = [place / (8 << size) for place in point]
        borders += any(cell.denominator == 1 for cell in cells)
        held = {"found_surface_axis": axis, "found_surface_cell": size, "found_distance": n, "found_slope": e}
        held |= by_axis("eye_", eye) | slope_inputs(slope)
        for cycle in range(7):
            leaf.case({**held, "steps_load_divider": cycle == 0, "steps_store_quotient": cycle == 3})
        leaf.expect({"odd_u": int(cells[0]) % 2, "odd_v": int(cells[1]) % 2})
    leaf.check(settled=6)
    assert borders > 30
