# SPDX-License-Identifier: MIT
"""Leaf tests of `hit_component`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

import pytest
from vectors import check, leaf_of

from raycaster.hdl.signals import Signed
from raycaster.rtl.exact.hit_component import hit_component


@pytest.mark.parametrize(
    ("eye_bits", "slope_bits", "bits"), [(10, 8, 17), (12, 18, 28)], ids=["narrow", "as wide as its result"]
)
def test_hit_component(eye_bits, slope_bits, bits, tmp_path, random):
    """The lowest bits of E e + D n, for all combinations of operands at their limits, and for random ones."""
    widths = {"eye": Signed(eye_bits), "slope": slope_bits, "distance": eye_bits - 1, "e": slope_bits}
    leaf = leaf_of(hit_component, tmp_path, **widths, component=bits)
    most, steepest = (1 << (eye_bits - 1)) - 1, (1 << slope_bits) - 1
    cases = list(product((-most - 1, -1, 0, 1, most), (0, 1), (0, 1, steepest), (0, 1, most), (0, 1, steepest)))
    limits = ((-most - 1, most), (0, 1), (0, steepest), (0, most), (0, steepest))
    cases += [tuple(int(random.integers(low, high + 1)) for low, high in limits) for _ in range(300)]
    stimulus = [dict(zip(("eye", "back", "slope", "distance", "e"), case, strict=True)) for case in cases]
    results = [eye * e + (-slope if back else slope) * distance for eye, back, slope, distance, e in cases]
    check(leaf, stimulus, [{"component": result % (1 << bits)} for result in results])
