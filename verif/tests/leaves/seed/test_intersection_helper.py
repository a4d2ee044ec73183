# SPDX-License-Identifier: MIT
"""`intersection_helper`: corner cases, random operands, products with every bit visible, and powers of two."""

import pytest
from arithmetic_vectors import SLOPE_CORNERS, VECTORS, arithmetic, position_corners

from raycaster.golden import seed_engine
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits
from raycaster.rtl.seed.intersection_helper import intersection_helper

POWERS = tuple(1 << place for place in range(SLOPE_BITS))


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_intersection_helper(config, leaf_of, random):
    width = position_bits(config)
    widths = dict.fromkeys(("a", "c", "d", "quotient", "distance"), width) | dict.fromkeys("be", SLOPE_BITS)
    leaf = leaf_of(intersection_helper, config, **widths, value=Signed(width + 2))
    corners = position_corners(config)

    def position() -> int:
        return int(random.choice(corners) if random.random() < 0.4 else random.integers(1 << width))

    def slope() -> int:
        corner = random.choice([*SLOPE_CORNERS, *POWERS])
        magnitude = corner if random.random() < 0.4 else random.integers(1 << SLOPE_BITS)
        return int(magnitude * random.choice([-1, 1]))

    operands = [(position(), slope(), position(), position(), slope()) for _ in range(VECTORS)]
    for number in range(VECTORS):
        # Products with every bit visible in the quotient, and distances with a single bit set.
        c, b, e = position(), int(random.choice([1, 2, 3, 5])), int(random.choice(POWERS))
        distance = int(random.choice([1 << random.integers(width), random.integers(1, 100)]))
        if number % 2:
            b = e = int(random.integers(1 << SLOPE_BITS)) | 1
            distance = int(random.integers(1 << width)) | 1
        d = c - distance if c >= distance else min(c + distance, (1 << width) - 1)
        operands.append((position(), b * int(random.choice([-1, 1])), c, d, e * int(random.choice([-1, 1]))))
    steps, valid_seen = config.divider_steps, 0
    idle = dict.fromkeys(("steps_find_intersection", "steps_load_divider", "steps_store_quotient"), 0)
    leaf.stimulus = [dict(idle) for _ in range((len(operands) + 2) * steps + 6)]
    for number, (a, b, c, d, e) in enumerate(operands):
        start = number * steps
        leaf.stimulus[start] |= {"steps_find_intersection": 1, "b": abs(b), "b_negative": b < 0}
        leaf.stimulus[start] |= {"c": c, "d": d, "e": abs(e), "e_negative": e < 0}
        leaf.stimulus[start + 2]["steps_load_divider"] = 1
        stored = start + 3 + steps
        leaf.stimulus[stored - 1]["steps_store_quotient"] = 1
        leaf.stimulus[stored]["a"] = a
        value, valid = seed_engine.intersect(a, b, c, d, e, config.fraction_bits, config.rounding)
        leaf.expected[start + 1]["towards"] = (c - d) * e > 0
        leaf.expected[stored]["valid"] = valid
        if valid:
            valid_seen += 1
            leaf.expected[stored] |= {"quotient": abs(int(value) - a), "distance": abs(c - d)}
            leaf.expected[stored + 1]["value"] = value
    outputs = leaf.check(settled=steps + 4)
    assert outputs[1]["towards"] == leaf.expected[1]["towards"]
    assert valid_seen > VECTORS // 10
