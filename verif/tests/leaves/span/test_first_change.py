# SPDX-License-Identifier: MIT
"""Leaf test of `first_change`: lines that rise and fall, to 0 and across it, with the change in any column."""

import pytest
from span_vectors import span_config
from vectors import named

from raycaster.hdl.signals import bit
from raycaster.rtl.common.widths import column_bits, divisor_bits, line_bits
from raycaster.rtl.span.first_change import division_cycles, first_change
from raycaster.rtl.span.records import Division

DESIGNS = [
    {"screen": "tiny"},
    {"turn": True, "reflections": 4},
    {"rows": 180, "scale": 6, "turn": True, "patterns": True},
]


@pytest.mark.parametrize("options", DESIGNS, ids=str)
def test_first_change(options, leaf_of, random):
    config = span_config(**options)
    columns, steepest = config.screen_geometry.columns, (1 << divisor_bits(config) - 1) - 1
    ports = {"start": bit, "division": lambda: Division(config), "columns": column_bits(config)}
    leaf, cycles, seen = leaf_of(first_change, config, **ports), division_cycles(config), set()
    leaf.stimulus += [{"reset": 1, "start": 0}, {"reset": 0}]
    for _ in range(leaf.some(400)):
        size = int(random.choice([1, 2, steepest, steepest - 1, int(random.integers(1, steepest + 1))]))
        growth = size * int(random.choice([-1, 1]))
        before = int(random.choice([1, 2, columns - 1, int(random.integers(1, columns))]))
        # The value at the change is 0 or more, or less than 0, and one step before it is not.
        past = int(random.choice([0, size - 1, int(random.integers(size))]))
        value = past - before * growth if growth > 0 else -1 - past - before * growth
        if not -(1 << line_bits(config) - 1) <= value < 1 << line_bits(config) - 1:
            continue
        # Some lines are not asked for.
        start = int(random.random() < 0.7)
        leaf.case({"start": start, **named("division", {"value": value, "growth": growth})})
        leaf.expected[leaf.cycle - 1 + cycles] |= {"done": start, **({"columns": before} if start else {})}
        seen.add((growth > 0, past == 0, before == columns - 1))
    leaf.stimulus += [{"start": 0}] * (cycles + 1)
    leaf.check(settled=cycles + 2)
    assert len(seen) == 8


def test_a_reset_ends_a_division(leaf_of):
    config = span_config(screen="tiny")
    ports = {"start": bit, "division": lambda: Division(config), "columns": column_bits(config)}
    leaf, steps = leaf_of(first_change, config, **ports), division_cycles(config) - 1
    leaf.case({"reset": 1, "start": 0, "division_value": -9, "division_growth": 3})
    leaf.stimulus += [{"reset": 0, "start": 1}, *[{"start": 0}] * (steps + 2)]
    whole = leaf.cycle
    for reset in range(steps):
        leaf.stimulus += [{"reset": 0, "start": 1}, *[{"start": 0}] * reset, {"start": 0, "reset": 1}, {"reset": 0}]
        leaf.stimulus += [{}] * (steps + 1)
    leaf.expected |= {cycle: {"done": 0} for cycle in range(whole, leaf.cycle)}
    leaf.check(settled=whole)
