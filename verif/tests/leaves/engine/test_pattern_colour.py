# SPDX-License-Identifier: MIT
"""Leaf tests of `pattern_colour`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import product

from vectors import ports

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.records import Look
from raycaster.rtl.common.widths import RGB_BITS
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.scene import PATTERNS


def test_pattern_colour(tmp_path, random):
    """Every pattern in every kind of cell, with two complementary colours and random ones."""
    leaf = Leaf(pattern_colour, lambda: ports(
        "odd_u odd_v", look=Look(materials=True, patterns=True), colour=unsigned(RGB_BITS)
    ), tmp_path)  # fmt: skip
    stimulus, expected = [], []
    for kind, odd_u, odd_v in product(range(len(PATTERNS)), range(2), range(2)):
        second = (0, (odd_u + odd_v) % 2, odd_v, odd_u)[kind]
        for colours in ((0, (1 << RGB_BITS) - 1), ((1 << RGB_BITS) - 1, 0), random.integers(1 << RGB_BITS, size=2)):
            look = {"kind": kind, "colour": int(colours[0]), "colour_2": int(colours[1])}
            look |= {"mirror": int(random.integers(5)), "cell": int(random.integers(8))}
            stimulus.append({**{f"look_{name}": one for name, one in look.items()}, "odd_u": odd_u, "odd_v": odd_v})
            expected.append(int(colours[second]))
    outputs = leaf.run_both(stimulus)
    assert [output["colour"] for output in outputs] == expected
