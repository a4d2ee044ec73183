# SPDX-License-Identifier: MIT
"""`hit_component`: the lowest bits of E e + D n, for combinations of operands at their limits, and for random ones."""

from itertools import product

import pytest

from raycaster.hdl.signals import Signed
from raycaster.rtl.exact.hit_component import hit_component


@pytest.mark.parametrize(
    ("eye_bits", "slope_bits", "bits"), [(10, 8, 17), (12, 18, 28)], ids=["narrow", "as wide as its result"]
)
def test_hit_component(eye_bits, slope_bits, bits, leaf_of, random):
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
