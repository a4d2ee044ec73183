# SPDX-License-Identifier: MIT
"""Leaf tests of `extent_tester`: MyHDL and converted Verilog match the expected values on the same vectors."""

from fractions import Fraction

import numpy as np
from exact_vectors import by_reflections, exact_config
from vectors import LAST, ports

from raycaster.configuration import WORLD_SIZE
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.common.widths import exact_slope_bits, eye_bits
from raycaster.rtl.exact.extent_tester import extent_tester


@by_reflections
def test_extent_tester(reflections, tmp_path, random):
    """Rays that meet the plane before, at and beyond the bounds and the mirror, computed with fractions."""
    config = exact_config(reflections=reflections)
    eye_width, slope_bits = eye_bits(config), exact_slope_bits(config)
    leaf = Leaf(extent_tester, lambda: ports(
        "clk step back on_mirror ahead between in_mirror", low=unsigned(9), high=unsigned(9), eye=signed(eye_width),
        slope=unsigned(slope_bits), mirror_distance=unsigned(eye_width - 1), n=unsigned(eye_width - 1),
        e=unsigned(slope_bits)
    ), tmp_path)  # fmt: skip
    far, steepest = LAST * (reflections + 1), (1 << slope_bits) - 1
    stimulus, aheads, expected, late = [], {}, {}, {}
    for cycle in range(6000):
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
        stimulus.append(late | {
            "step": step, "low": low, "high": high, "eye": eye % (1 << eye_width), "back": back, "slope": slope,
            "on_mirror": on_mirror,
        })  # fmt: skip
        late = {"mirror_distance": min(mirror, (1 << eye_width - 1) - 1), "n": n, "e": e}
        aheads[cycle] = beyond >= 0
        if step and beyond >= 0:
            at, mirror = Fraction(slope * n, e), late["mirror_distance"]
            behind_mirror = on_mirror and near <= mirror and at < mirror
            expected[cycle + 2] = near <= at <= beyond and not behind_mirror, bool(on_mirror and near <= mirror == at)
    outputs = leaf.run_both([*stimulus, late, {}], settled=2)
    assert {value for pair in expected.values() for value in pair} == {False, True}
    for cycle, ahead in aheads.items():
        assert bool(outputs[cycle]["ahead"]) == ahead or cycle < 2, cycle
    for cycle, wanted in expected.items():
        assert tuple(bool(outputs[cycle][name]) for name in ("between", "in_mirror")) == wanted, (
            stimulus[cycle - 2 : cycle]
        )  # fmt: skip
