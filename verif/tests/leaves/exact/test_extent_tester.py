# SPDX-License-Identifier: MIT
"""`extent_tester`: rays that meet the plane before, at and beyond the bounds and the mirror, by fractions."""

from fractions import Fraction

import numpy as np
from vectors import LAST, by_reflections, exact_config

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.extent_tester import extent_tester


@by_reflections
def test_extent_tester(reflections, leaf_of, random):
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
