# SPDX-License-Identifier: MIT
"""Leaf tests of `hit_component`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

import pytest
from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.exact.hit_component import hit_component


@pytest.mark.parametrize(
    ("eye_bits", "slope_bits", "bits"), [(10, 8, 17), (12, 18, 28)], ids=["narrow", "as wide as its result"]
)
def test_hit_component(eye_bits, slope_bits, bits, tmp_path, random):
    """The lowest bits of E e + D n, for all combinations of operands at their limits, and for random ones."""
    leaf = Leaf(hit_component, lambda: ports(
        "back", eye=signed(eye_bits), slope=unsigned(slope_bits), distance=unsigned(eye_bits - 1),
        e=unsigned(slope_bits), component=unsigned(bits)
    ), tmp_path)  # fmt: skip
    most, steepest = (1 << (eye_bits - 1)) - 1, (1 << slope_bits) - 1
    cases = list(product((-most - 1, -1, 0, 1, most), (0, 1), (0, 1, steepest), (0, 1, most), (0, 1, steepest)))
    cases += [
        (
            int(random.integers(-most - 1, most + 1)), int(random.integers(2)), int(random.integers(steepest + 1)),
            int(random.integers(most + 1)), int(random.integers(steepest + 1)),
        )
        for _ in range(300)
    ]  # fmt: skip
    names = ("eye", "back", "slope", "distance", "e")
    stimulus = [
        dict(zip(names, (eye % (1 << eye_bits), *others), strict=True)) for eye, *others in cases
    ]  # fmt: skip
    outputs = leaf.run_both(stimulus)
    for case, output in zip(cases, outputs, strict=True):
        eye, back, slope, distance, e = case
        assert output["component"] == (eye * e + (-slope if back else slope) * distance) % (1 << bits), case
