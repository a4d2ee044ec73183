# SPDX-License-Identifier: MIT
"""`bound_tester`: ways at and next to a bound, for rays in either direction; a way may be wider than the bounds."""

import numpy as np
from vectors import by

from raycaster.hdl.signals import Signed
from raycaster.rtl.beam.bound_tester import bound_tester


@by(spare=[0, 2])
def test_bound_tester(spare, leaf_of, random):
    bits = 12
    leaf = leaf_of(bound_tester, way=Signed(bits + spare), low=Signed(bits), high=Signed(bits))
    most, between = (1 << bits - 1) - 1, None
    for number in range(3000):
        low, high = (int(random.choice([-most - 1, -1, 0, most, random.integers(-most, most)])) for _ in range(2))
        way = int(random.choice([low, high])) + int(random.integers(-1, 2))
        way = int(random.choice([way, random.integers(-most << spare, most << spare)]))
        way = int(np.clip(way, -(most + 1) << spare, most << spare))
        step, back = int(number == 0 or random.random() < 0.8), int(random.integers(2))
        if step:
            between = high <= way <= low if back else low <= way <= high
        leaf.case({"step": step, "back": back, "way": way, "low": low, "high": high}, {"between": between})
    leaf.check(latency=1)
