# SPDX-License-Identifier: MIT
"""The divider and the a + b * (c - d) / e unit: MyHDL, the converted Verilog and golden on one set of vectors."""

import numpy as np
import pytest

from raycaster.configuration import Configuration, configure
from raycaster.golden import seed_engine
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.widths import SLOPE_BITS, bit, position_bits, product_bits, signed, unsigned
from raycaster.rtl.engine.array_multiplier import array_multiplier
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.rtl.engine.multiplier_step import multiplier_step
from raycaster.rtl.seed.divider import divider
from raycaster.rtl.seed.intersection_helper import intersection_helper
from raycaster.verif.leaf import Leaf
from raycaster.verif.seeds import repeat, seed

VECTORS = 300
SLOPE_CORNERS = (0, 1, 2, 100, 160, 190, 255, 256, 510, 511)
POWERS = tuple(1 << place for place in range(SLOPE_BITS))

arithmetic = pytest.mark.parametrize(
    "config",
    [
        configure(fraction_bits=bits, rounding=rounding, divider_bits=divider_bits, allow_underrun=True)
        for bits in (0, 1, 4, 8)
        for rounding in ("truncate", "nearest")
        for divider_bits in (1, 2, 3)
    ],
    ids=lambda config: f"F{config.fraction_bits}-{config.rounding}-{config.divider_bits}bits",
)


def position_corners(config: Configuration) -> list[int]:
    one = 1 << config.fraction_bits
    whole = [0, 1, 2, 255, 256, 510, 511]
    return sorted({value * one for value in whole} | {value * one + one - 1 for value in whole} | {1, one})


def dividends_and_divisors(config: Configuration) -> list[tuple[int, int]]:
    """Corners and random operands, with every quotient that rounding or overflow could get wrong made often."""
    random = np.random.default_rng(seed())
    limit = 1 << position_bits(config)
    operands = [(n * d, e) for n in position_corners(config) for d in SLOPE_CORNERS for e in SLOPE_CORNERS if n < limit]
    chosen = [operands[index] for index in random.permutation(len(operands))[: VECTORS // 2]]
    for _ in range(VECTORS):
        divisor = int(random.integers(1, 1 << SLOPE_BITS))
        quotient = int(random.choice([0, 1, limit - 2, limit - 1, limit, random.integers(limit)]))
        remainder = int(random.choice([0, divisor // 2, (divisor + 1) // 2, divisor - 1]))
        chosen.append((min(quotient * divisor + remainder, (1 << product_bits(config)) - 1), divisor))
    return chosen


@pytest.mark.parametrize(("width", "count"), [(1, 2), (2, 3), (4, 4), (9, 9), (9, 17)])
def test_divider_step(width, count, tmp_path):
    leaf = Leaf(
        divider_step,
        lambda: {
            "remainder": unsigned(width),
            "digits": unsigned(count),
            "divisor": unsigned(width),
            "next_remainder": unsigned(width),
            "next_digits": unsigned(count),
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    divisors = range(1, 1 << width) if width < 9 else SLOPE_CORNERS[1:]
    stimulus = [
        {"remainder": remainder, "digits": digits, "divisor": divisor}
        for divisor in divisors
        for remainder in (range(divisor) if width < 9 else {0, divisor // 2, divisor - 1})
        for digits in {0, (1 << count) - 1, 1 << count - 1, int(random.integers(1 << count))}
    ]
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        digit, others = divmod(inputs["digits"], 1 << count - 1)
        quotient, remainder = divmod(2 * inputs["remainder"] + digit, inputs["divisor"])
        assert outputs == {"next_remainder": remainder, "next_digits": 2 * others + quotient}, (inputs, repeat())


@pytest.mark.parametrize("subtract", [False, True])
@pytest.mark.parametrize(("width", "count"), [(3, 3), (4, 2), (11, 9)])
def test_multiplier_step(width, count, subtract, tmp_path):
    leaf = Leaf(
        multiplier_step,
        lambda: {
            "multiplicand": signed(width),
            "total": signed(width),
            "digits": unsigned(count),
            "next_total": signed(width),
            "next_digits": unsigned(count),
            "subtract": subtract,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [
        {"multiplicand": multiplicand, "total": total, "digits": digits}
        for multiplicand in factors(random, width)
        for total in factors(random, width)
        for digits in {0, (1 << count) - 1, 1, int(random.integers(1 << count))}
    ]
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        others, digit = divmod(inputs["digits"], 2)
        added = inputs["total"] + (-digit if subtract else digit) * inputs["multiplicand"]
        total, digits = added >> 1, (added & 1) << count - 1 | others
        assert outputs == {"next_total": total % (1 << width), "next_digits": digits}, (inputs, repeat())


def factors(random: np.random.Generator, width: int) -> list[int]:
    """All of them if they are few, else those at which digits and signs change, and some at random."""
    least, most = -(1 << width - 1), (1 << width - 1) - 1
    if width < 6:
        return list(range(least, most + 1))
    powers = {sign * (1 << place) + more for place in range(width - 1) for sign in (1, -1) for more in (-1, 0)}
    return sorted(powers | {least, most} | {int(value) for value in random.integers(least, most, size=8)})


@pytest.mark.parametrize(("width", "count", "kept"), [(4, 5, 9), (5, 3, 6), (10, 9, 18), (11, 9, 20)])
def test_array_multiplier(width, count, kept, tmp_path):
    leaf = Leaf(
        array_multiplier,
        lambda: {"multiplicand": signed(width), "multiplier": signed(count), "product": signed(kept)},
        tmp_path,
    )
    random = np.random.default_rng(seed())
    stimulus = [
        {"multiplicand": multiplicand, "multiplier": multiplier}
        for multiplicand in factors(random, width)
        for multiplier in factors(random, count)
    ]
    for inputs, outputs in zip(stimulus, leaf.run_both(stimulus), strict=True):
        product = inputs["multiplicand"] * inputs["multiplier"]
        assert outputs == {"product": product % (1 << kept)}, (inputs, repeat())


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_divider(config, tmp_path):
    leaf = Leaf(
        divider,
        lambda: {
            "clk": bit(),
            "load_divider": bit(),
            "store_quotient": bit(),
            "dividend": unsigned(product_bits(config)),
            "divisor": unsigned(SLOPE_BITS),
            "quotient": unsigned(position_bits(config)),
            "overflow": bit(),
            "config": config,
        },
        tmp_path,
    )
    operands = dividends_and_divisors(config)
    steps = config.divider_steps
    stimulus = []
    for number, (dividend, divisor) in enumerate(operands):
        # Back to back: a load comes together with the store of the division before.
        stimulus.append(
            {"load_divider": 1, "store_quotient": int(number > 0), "dividend": dividend, "divisor": divisor}
        )
        stimulus += [{"load_divider": 0, "store_quotient": 0, "dividend": 0, "divisor": 0}] * (steps - 1)
    stimulus += [{"load_divider": 0, "store_quotient": 1}, {"store_quotient": 0}]
    outputs = leaf.run_both(stimulus, settled=steps + 1)
    for number, (dividend, divisor) in enumerate(operands):
        quotient, overflow = seed_engine.divide(dividend, divisor, config.fraction_bits, config.rounding)
        result = outputs[(number + 1) * steps + 1]
        assert bool(result["overflow"]) == bool(overflow), (dividend, divisor, repeat())
        if not overflow:
            assert result["quotient"] == quotient, (dividend, divisor, repeat())


@pytest.mark.slow_sets("F1", "F4")
@arithmetic
def test_intersection_helper(config, tmp_path):
    width = position_bits(config)
    leaf = Leaf(
        intersection_helper,
        lambda: {
            "clk": bit(),
            "steps": Steps(),
            "a": unsigned(width),
            "b": unsigned(SLOPE_BITS),
            "b_negative": bit(),
            "c": unsigned(width),
            "d": unsigned(width),
            "e": unsigned(SLOPE_BITS),
            "e_negative": bit(),
            "value": signed(width + 2),
            "quotient": unsigned(width),
            "distance": unsigned(width),
            "valid": bit(),
            "towards": bit(),
            "config": config,
        },
        tmp_path,
    )
    random = np.random.default_rng(seed())
    corners = position_corners(config)

    def position() -> int:
        return int(random.choice(corners) if random.random() < 0.4 else random.integers(1 << width))

    def slope() -> int:
        corner = random.choice([*SLOPE_CORNERS, *POWERS])
        magnitude = corner if random.random() < 0.4 else random.integers(1 << SLOPE_BITS)
        return int(magnitude * random.choice([-1, 1]))

    operands = [(position(), slope(), position(), position(), slope()) for _ in range(VECTORS)]
    for number in range(VECTORS):
        # Products whose every bit tells in the quotient, and distances with a single one.
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
        assert bool(stored["valid"]) == bool(valid), (vector, repeat())
        assert bool(outputs[number * steps + 1]["towards"]) == ((c - d) * e > 0), (vector, repeat())
        if valid:
            valid_seen += 1
            assert added["value"] == int(value) % (1 << (width + 2)), (vector, repeat())
            assert stored["quotient"] == abs(int(value) - a), (vector, repeat())
            assert stored["distance"] == abs(c - d), (vector, repeat())
    assert valid_seen > VECTORS // 10
