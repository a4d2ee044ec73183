# SPDX-License-Identifier: MIT
"""Leaf tests of arithmetic that several blocks use, and of the synchroniser."""

from itertools import pairwise

import pytest
from arithmetic_vectors import SLOPE_CORNERS, factors
from vectors import by

from raycaster.hdl.signals import Signed, reset_signal
from raycaster.rtl.common.magnitude import magnitude
from raycaster.rtl.common.synchroniser import synchroniser
from raycaster.rtl.engine.array_multiplier import array_multiplier
from raycaster.rtl.engine.divider_step import divider_step
from raycaster.rtl.engine.multiplier_step import multiplier_step


@pytest.mark.parametrize(("value_bits", "bits"), [(2, 1), (5, 4), (10, 9), (13, 9)])
def test_magnitude(value_bits, bits, leaf_of):
    """Every value whose magnitude fits."""
    leaf = leaf_of(magnitude, value=Signed(value_bits), result=bits)
    for value in range(1 - (1 << bits), 1 << bits):
        leaf.case({"value": value}, {"result": abs(value)})
    leaf.check()


@by(width=[1, 5], resettable=[False, True])
def test_synchroniser(width, resettable, leaf_of, random):
    widths = {"value": width, "held": width} if width > 1 else {}
    leaf = leaf_of(synchroniser, reset=reset_signal if resettable else lambda: None, **widths)
    leaf.stimulus = [{"value": int(random.integers(1 << width))} for _ in range(200)]
    if resettable:
        leaf.stimulus = [cycle | {"reset": int(random.random() < 0.1)} for cycle in leaf.stimulus]
    for cycle, (before, last) in enumerate(pairwise(leaf.stimulus)):
        leaf.expected[cycle]["held"] = 0 if before.get("reset") or last.get("reset") else before["value"]
    leaf.check(latency=2)


@pytest.mark.parametrize(("width", "count", "kept"), [(4, 5, 9), (5, 3, 6), (10, 9, 18), (11, 9, 20)])
def test_array_multiplier(width, count, kept, leaf_of, random):
    """Factors at their limits, with single bits, and random ones."""
    widths = {"multiplicand": Signed(width), "multiplier": Signed(count), "product": Signed(kept)}
    leaf = leaf_of(array_multiplier, **widths)
    for one in factors(random, width):
        for other in factors(random, count):
            leaf.case({"multiplicand": one, "multiplier": other}, {"product": one * other % (1 << kept)})
    leaf.check()


@pytest.mark.parametrize("subtract", [False, True])
@pytest.mark.parametrize(("width", "count"), [(3, 3), (4, 2), (11, 9)])
def test_multiplier_step(width, count, subtract, leaf_of, random):
    """One bit of the multiplier; the lowest bit of the sum becomes the highest digit."""
    widths = dict.fromkeys(("multiplicand", "total", "next_total"), Signed(width))
    leaf = leaf_of(multiplier_step, **widths, digits=count, next_digits=count, subtract=subtract)
    for multiplicand in factors(random, width):
        for total in factors(random, width):
            for digits in {0, (1 << count) - 1, 1, int(random.integers(1 << count))}:
                leaf.case({"multiplicand": multiplicand, "total": total, "digits": digits})
                others, digit = divmod(digits, 2)
                added = total + (-digit if subtract else digit) * multiplicand
                leaf.expect({"next_total": added >> 1, "next_digits": (added & 1) << count - 1 | others})
    leaf.check()


@pytest.mark.parametrize(("width", "count"), [(1, 2), (2, 3), (4, 4), (9, 9), (9, 17)])
def test_divider_step(width, count, leaf_of, random):
    """One bit of the quotient, for every divisor or those at the limits."""
    widths = dict.fromkeys(("remainder", "divisor", "next_remainder"), width)
    leaf = leaf_of(divider_step, **widths, digits=count, next_digits=count)
    for divisor in range(1, 1 << width) if width < 9 else SLOPE_CORNERS[1:]:
        for remainder in range(divisor) if width < 9 else {0, divisor // 2, divisor - 1}:
            for digits in {0, (1 << count) - 1, 1 << count - 1, int(random.integers(1 << count))}:
                leaf.case({"remainder": remainder, "digits": digits, "divisor": divisor})
                digit, others = divmod(digits, 1 << count - 1)
                quotient, left = divmod(2 * remainder + digit, divisor)
                leaf.expect({"next_remainder": left, "next_digits": 2 * others + quotient})
    leaf.check()
