# SPDX-License-Identifier: MIT
"""`shadow_register`: hits before, at and beyond the point, and next to it by one unit of either product."""

from fractions import Fraction

import numpy as np
import pytest

from raycaster.configuration import WORLD_SIZE
from raycaster.design.decide import configure
from raycaster.rtl.common.interfaces import AIM_CYCLES
from raycaster.rtl.common.widths import exact_slope_bits, light_slope_bits
from raycaster.rtl.exact.shadow_register import shadow_register

CYCLES = 2000
LAST_AIM = 1 << AIM_CYCLES - 1


@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
def test_shadow_register(turn, leaf_of, random):
    config = configure(engine="exact", turn=turn, light=True)
    leaf = leaf_of(shadow_register, config, denominator=light_slope_bits(config))
    steepest, most = (1 << exact_slope_bits(config)) - 1, (1 << light_slope_bits(config)) - 1
    shaded, looking, kinds, e = None, None, set(), 1
    for cycle in range(CYCLES):
        starts = cycle == 0 or random.random() < 0.2
        if starts:
            e = int(random.choice([1, 2, steepest, random.integers(1, steepest + 1)]))
        n = int(random.choice([1, WORLD_SIZE - 1, random.integers(1, WORLD_SIZE)]))
        near = n * e + int(random.integers(-1, 2))
        denominator = int(np.clip(random.choice([near, 2 * near, random.integers(1, most + 1)]), 1, most))
        hit, write = int(random.random() < 0.4), int(not starts and random.random() < 0.5)
        aim = 1 if starts else int(random.choice([0, 0, 2, 4, LAST_AIM]))
        over, asked = int(cycle == 0 or random.random() < 0.2), int(random.random() < 0.5)
        steps = {"steps_aim": aim, "steps_reset_z_buf": over, "steps_write_shadow": write, "in_question": asked}
        terms = {"hit": hit, "numerator": n, "denominator": denominator, "found_slope": e}
        leaf.case(steps | terms, {"shaded": shaded, "looking": looking})
        if over:
            looking = 0
        elif aim == LAST_AIM:
            looking = asked
        if starts:
            shaded = 0
        elif write and hit:
            between = Fraction(n, denominator) < Fraction(1, e)
            kinds.add((between, n * e - denominator if abs(n * e - denominator) < 2 else None))
            shaded |= int(between)
    leaf.check(settled=1)
    assert {(True, -1), (False, 0), (False, 1)} <= kinds
