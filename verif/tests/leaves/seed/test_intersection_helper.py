# SPDX-License-Identifier: MIT
"""Leaf tests of `intersection_helper`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from arithmetic_vectors import SLOPE_CORNERS, VECTORS, arithmetic, position_corners
from vectors import ports

from raycaster.golden import seed_engine
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import signed, unsigned
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits
from raycaster.rtl.seed.intersection_helper import intersection_helper

POWERS = tuple(1 << place for place in range(SLOPE_BITS))


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_intersection_helper(config, tmp_path, random):
    width = position_bits(config)
    leaf = Leaf(intersection_helper, lambda: ports(
        "clk b_negative e_negative valid towards", steps=Steps(), a=unsigned(width), b=unsigned(SLOPE_BITS),
        c=unsigned(width), d=unsigned(width), e=unsigned(SLOPE_BITS), value=signed(width + 2),
        quotient=unsigned(width), distance=unsigned(width), config=config
    ), tmp_path)  # fmt: skip
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
    steps = config.divider_steps
    idle = {"steps_find_intersection": 0, "steps_load_divider": 0, "steps_store_quotient": 0}
    stimulus = [dict(idle) for _ in range((len(operands) + 2) * steps + 6)]
    for number, (a, b, c, d, e) in enumerate(operands):
        start = number * steps
        stimulus[start] |= {"steps_find_intersection": 1, "b": abs(b), "b_negative": int(b < 0)}
        stimulus[start] |= {"c": c, "d": d, "e": abs(e), "e_negative": int(e < 0)}
        stimulus[start + 2]["steps_load_divider"] = 1
        stimulus[start + 2 + steps]["steps_store_quotient"] = 1
        stimulus[start + 3 + steps]["a"] = a
    outputs = leaf.run_both(stimulus, settled=steps + 4)
    valid_seen = 0
    for number, (a, b, c, d, e) in enumerate(operands):
        value, valid = seed_engine.intersect(a, b, c, d, e, config.fraction_bits, config.rounding)
        stored = outputs[number * steps + steps + 3]
        added = outputs[number * steps + steps + 4]
        vector = {"a": a, "b": b, "c": c, "d": d, "e": e}
        assert bool(stored["valid"]) == bool(valid), vector
        assert bool(outputs[number * steps + 1]["towards"]) == ((c - d) * e > 0), vector
        if valid:
            valid_seen += 1
            assert added["value"] == int(value) % (1 << (width + 2)), vector
            assert stored["quotient"] == abs(int(value) - a), vector
            assert stored["distance"] == abs(c - d), vector
    assert valid_seen > VECTORS // 10
