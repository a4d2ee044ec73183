# SPDX-License-Identifier: MIT
"""`pattern_colour`: every pattern in every kind of cell, with two complementary colours and random ones."""

from itertools import product

from vectors import named

from raycaster.design.decide import configure
from raycaster.rtl.common.records import Look
from raycaster.rtl.common.widths import RGB_BITS
from raycaster.rtl.engine.pattern_colour import pattern_colour
from raycaster.scene import PATTERNS


def test_pattern_colour(leaf_of, random):
    leaf = leaf_of(pattern_colour, look=lambda: Look(configure(materials=True, patterns=True)), colour=RGB_BITS)
    for kind, odd_u, odd_v in product(range(len(PATTERNS)), range(2), range(2)):
        second = (0, (odd_u + odd_v) % 2, odd_v, odd_u)[kind]
        for colours in ((0, (1 << RGB_BITS) - 1), ((1 << RGB_BITS) - 1, 0), random.integers(1 << RGB_BITS, size=2)):
            look = {"kind": kind, "colour": colours[0], "colour_2": colours[1]}
            look |= {"mirror": random.integers(5), "cell": random.integers(8)}
            leaf.case({**named("look", look), "odd_u": odd_u, "odd_v": odd_v}, {"colour": colours[second]})
    leaf.check()
