# SPDX-License-Identifier: MIT
"""Leaf tests of the exact engine's blocks for shadows."""

from fractions import Fraction

import numpy as np
import pytest
from vectors import LAST, by_axis, exact_config, named, slope_inputs

from raycaster.configuration import WORLD_SIZE
from raycaster.design.decide import configure
from raycaster.rtl.common.interfaces import AIM_CYCLES, ShadowPass, Slope
from raycaster.rtl.common.records import Signs
from raycaster.rtl.common.widths import exact_slope_bits, light_slope_bits
from raycaster.rtl.exact.shadow_ray import shadow_ray
from raycaster.rtl.exact.shadow_register import shadow_register
from raycaster.rtl.exact.shadow_sequencer import shadow_sequencer
from raycaster.verif.random_world import EXTREMES

CASES = 200


@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
@pytest.mark.parametrize("reflections", [0, 2, 4])
def test_shadow_ray(reflections, turn, leaf_of, random):
    """S = N - e L and the side of the light, for points at the world's corners, on planes and anywhere."""
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


CYCLES = 2000
LAST_AIM = 1 << AIM_CYCLES - 1


@pytest.mark.parametrize("turn", [False, True], ids=["not turned", "turned"])
def test_shadow_register(turn, leaf_of, random):
    """Hits before, at and beyond the point, and next to it by one unit of either product."""
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


AIM = 4
"""Cycles in which a shadow ray is computed."""


def test_shadow_sequencer(leaf_of, random):
    """Passes of any length and outcome.

    Nothing is in question, or it is decided early, or it is tested to the last rectangle. traced is not read in the
    cycles of aim.
    """
    leaf = leaf_of(shadow_sequencer, shadow_pass=ShadowPass, aim=AIM)
    names = ("aim", "from_light", *(f"shadow_pass_{name}" for name in ("awaited", "comes_next", "start", "stop")))

    def cycle(traced: int, question: int | None, *values: int, reset: int = 0) -> None:
        asked = int(random.integers(2)) if question is None else question
        leaf.case({"reset_ray_caster": reset, "shadow_pass_traced": traced, "any_in_question": asked})
        leaf.expect(dict(zip(names, values, strict=True)))

    waiting = (0, 0, 1, 1, 0, 0)
    cycle(0, None, *waiting, reset=1)
    outcomes = set()
    for _ in range(300):
        for _ in range(int(random.integers(4))):
            cycle(0, None, *waiting)
        cycle(1, None, *waiting)
        if random.random() < 0.05:
            cycle(1, None, 1, 0, 1, 1, 0, 0, reset=1)
            continue
        for number in range(AIM - 1):
            cycle(int(random.integers(2)), None, 1 << number, 0, 1, 1, 0, 0)
        question = int(random.integers(2))
        cycle(int(random.integers(2)), question, 1 << AIM - 1, 0, question, 0, question, 0)
        if not question:
            outcomes.add("none")
            continue
        length, decided = int(random.integers(1, 6)), int(random.integers(1, 8))
        for number in range(1, length + 1):
            in_question, last = int(number < decided), number == length
            stops = not in_question and not last
            cycle(int(last), in_question, 0, 1, 0, 0, 0, int(stops))
            if stops:
                # All tests are dropped, so the pass is over in the next cycle.
                cycle(1, 0, 0, 1, 0, 0, 0, 0)
                outcomes.add("decided")
                break
        else:
            outcomes.add("whole")
    leaf.check(settled=1)
    assert outcomes == {"none", "decided", "whole"}
