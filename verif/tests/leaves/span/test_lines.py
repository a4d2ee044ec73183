# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that evaluate lines, and of a row's slope."""

from __future__ import annotations

import pytest
from span_vectors import any_slope, line_inputs, span_config
from vectors import basis_inputs, by_axis, named

from raycaster.golden.rays import primary_slopes
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.widths import (
    divisor_bits,
    furthest,
    line_bits,
    signed_slope_bits,
    steepest_slope,
    step_bits,
)
from raycaster.rtl.span.first_change import division_cycles, first_change
from raycaster.rtl.span.line_eval import LATENCY, line_eval
from raycaster.rtl.span.operand_ends import operand_ends
from raycaster.rtl.span.row_slope import row_slope
from raycaster.rtl.span.slope_start import slope_start
from raycaster.scene import UNTURNED
from raycaster.verif.random_world import random_basis

SCREENS = [{"screen": "tiny"}, {"screen": "tiny", "turn": True}, {"rows": 180, "scale": 3, "turn": True}]


@pytest.mark.parametrize("options", SCREENS, ids=str)
def test_row_slope(options, leaf_of, random):
    """The slope of the first column of each row of a screen."""
    config = span_config(**options)
    leaf, screen = leaf_of(row_slope, config), config.screen_geometry
    for frame in range(2 if screen.rows > 100 else 6):
        basis = random_basis(random) if config.turn else UNTURNED
        if frame == 1 and config.turn:
            basis = ((-512, 511, -512),) * 3
        leaf.stimulus += [basis_inputs(basis) | {"next_row": 0}, {"first_row": 1}, {"first_row": 0}]
        for slope in primary_slopes(screen, basis)[:, 0].tolist():
            wait = int(random.integers(3))
            leaf.stimulus += [{"next_row": 0}] * wait
            leaf.case({"next_row": 1}, by_axis("slope_", slope))
    leaf.check(settled=3, spare=True)


def test_slope_start(leaf_of, random):
    config = span_config(screen="tiny", turn=True)
    bits = dict.fromkeys(("forward", "right", "up"), Signed(10)) | {"component": Signed(signed_slope_bits(config))}
    leaf, screen = leaf_of(slope_start, config, **bits), config.screen_geometry
    for _ in range(8):
        forward, right, up = random.choice([-512, 511, *random.integers(-512, 512, 3)], 3).tolist()
        leaf.stimulus += [
            {"forward": forward, "right": right, "up": up, "next_row": 0},
            {"first_row": 1},
            {"first_row": 0},
        ]
        for row in range(screen.rows):
            slope = screen.view_distance * forward - screen.centre_column * right + (screen.horizon_row - row) * up
            leaf.case({"next_row": 1}, {"component": slope})
    leaf.check(settled=3)


DESIGNS = [
    {"screen": "tiny"}, {"reflections": 4, "patterns": True}, {"turn": True, "reflections": 2},
    {"rows": 180, "scale": 6, "turn": True, "reflections": 4, "patterns": True},
    {"turn": True, "reflections": 1, "light": True}, {"rows": 180, "scale": 6, "reflections": 4, "light": True},
]  # fmt: skip


@pytest.mark.parametrize("options", DESIGNS, ids=str)
def test_line_eval(options, leaf_of, random):
    """Lines back to back, with the greatest operands of the screen."""
    config = span_config(**options)
    columns, far = config.screen_geometry.columns, furthest(config)
    # The greatest slope from the light, which is multiplied by distances within the world, and its greatest change.
    limits = [511 * steepest_slope(config)] * 2 + [2 * far << step_bits(config) - 1]
    leaf = leaf_of(line_eval, config)
    for _ in range(leaf.some(90)):
        slope, step = any_slope(random, config)
        held = by_axis("slope_", slope) | by_axis("step_", step)
        aim = [[int(random.choice([-1, 1]) * random.integers(limit + 1)) for limit in limits] for _ in range(4)]
        for axis, of_axis in zip("xyze", aim, strict=True):
            held |= {
                f"aim_{name}_{axis}": value for name, value in zip(("left", "right", "growth"), of_axis, strict=True)
            }
        for _ in range(20):
            from_light = int(config.light and random.random() < 0.5)
            ends = sorted(random.choice([0, columns - 1, *random.integers(columns, size=2)], 2).tolist())
            (left, right), strict = ends, int(random.integers(2))
            axes, backs = random.integers(3, size=2).tolist(), random.integers(2, size=2).tolist()
            most = 511 if from_light else far
            factors = random.choice([-most, -1, 0, 1, most, *random.integers(-most, most + 1, 2)], 2).tolist()
            asked = {
                "ask": int(random.random() < 0.9),
                "query_left": left,
                "query_right": right,
                "query_strict": strict,
            }
            tags = {
                "half_line": int(random.integers(2)),
                "last": int(random.integers(2)),
            }
            tags["number"] = int(random.integers(8))
            signed = [-factor if back else factor for factor, back in zip(factors, backs, strict=True)]
            values = [
                signed[0] * (slope[axes[0]] + column * step[axes[0]])
                - signed[1] * (slope[axes[1]] + column * step[axes[1]]) - strict
                for column in ends
            ]  # fmt: skip
            growth = signed[0] * step[axes[0]] - signed[1] * step[axes[1]]
            if from_light:
                axes = random.integers(4, size=2).tolist()
                x, y = (aim[axis] for axis in axes)
                values = [signed[0] * x[end] - signed[1] * y[end] - strict for end in range(2)]
                growth = signed[0] * x[2] - signed[1] * y[2]
            wanted = {"left": values[0], "right": values[1], "growth": growth, **tags}
            leaf.case(
                held
                | asked
                | line_inputs(axes, backs, factors)
                | {"query_from_light": from_light}
                | {f"query_{name}": tags[name] for name in tags}
            )
            leaf.expect({"answer_valid": asked["ask"]})
            leaf.expect({f"answer_{name}": value for name, value in wanted.items()}, when=asked["ask"])
        # The slope is constant while lines are evaluated.
        leaf.stimulus += [held | {"ask": 0}] * LATENCY
    leaf.check(LATENCY, spare=True)


@pytest.mark.parametrize("turn", [False, True])
def test_operand_ends(turn, leaf_of, random):
    config = span_config(turn=turn)
    columns = config.screen_geometry.columns
    ends = {"at_left": signed_slope_bits(config), "at_right": signed_slope_bits(config), "growth": step_bits(config)}
    leaf = leaf_of(operand_ends, config, axis=2, **{name: Signed(width) for name, width in ends.items()})
    for _ in range(leaf.some(150)):
        slope, step = any_slope(random, config)
        for _ in range(6):
            left, right = random.choice([0, columns - 1, int(random.integers(columns))], 2).tolist()
            axis = int(random.integers(3))
            leaf.case({"axis": axis, "left": left, "right": right} | by_axis("slope_", slope) | by_axis("step_", step))
            seen = {"at_left": slope[axis] + left * step[axis], "at_right": slope[axis] + right * step[axis]}
            leaf.expect(seen | {"growth": step[axis]})
        leaf.stimulus += [{}] * 2
    leaf.check(2, spare=True)


DIVISIONS = [
    {"screen": "tiny"},
    {"turn": True, "reflections": 4},
    {"rows": 180, "scale": 6, "turn": True, "patterns": True},
]


@pytest.mark.parametrize("options", DIVISIONS, ids=str)
def test_first_change(options, leaf_of, random):
    """Lines that rise and fall, to 0 and across it, with the change in any column."""
    config = span_config(**options)
    columns, steepest = config.screen_geometry.columns, (1 << divisor_bits(config) - 1) - 1
    leaf, cycles, seen = leaf_of(first_change, config), division_cycles(config), set()
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
    leaf, steps = leaf_of(first_change, config), division_cycles(config) - 1
    leaf.case({"reset": 1, "start": 0, "division_value": -9, "division_growth": 3})
    leaf.stimulus += [{"reset": 0, "start": 1}, *[{"start": 0}] * (steps + 2)]
    whole = leaf.cycle
    for reset in range(steps):
        leaf.stimulus += [{"reset": 0, "start": 1}, *[{"start": 0}] * reset, {"start": 0, "reset": 1}, {"reset": 0}]
        leaf.stimulus += [{}] * (steps + 1)
    leaf.expected |= {cycle: {"done": 0} for cycle in range(whole, leaf.cycle)}
    leaf.check(settled=whole)
