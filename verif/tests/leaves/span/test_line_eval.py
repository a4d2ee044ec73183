# SPDX-License-Identifier: MIT
"""Leaf tests of `line_eval` and `operand_ends`: lines back to back, with the greatest operands of the screen."""

from __future__ import annotations

import pytest
from span_vectors import any_slope, line_inputs, span_config
from vectors import by_axis

from raycaster.hdl.signals import Signed
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.widths import column_bits, furthest, span_slope_bits, steepest_slope, step_bits
from raycaster.rtl.span.line_eval import LATENCY, line_eval
from raycaster.rtl.span.operand_ends import operand_ends
from raycaster.rtl.span.records import Aim, Answer, Query

DESIGNS = [
    {"screen": "tiny"}, {"reflections": 4, "patterns": True}, {"turn": True, "reflections": 2},
    {"rows": 180, "scale": 6, "turn": True, "reflections": 4, "patterns": True},
    {"turn": True, "reflections": 1, "light": True}, {"rows": 180, "scale": 6, "reflections": 4, "light": True},
]  # fmt: skip


@pytest.mark.parametrize("options", DESIGNS, ids=str)
def test_line_eval(options, leaf_of, random):
    config = span_config(**options)
    columns, far = config.screen_geometry.columns, furthest(config)
    directions = {"slope": lambda: Vector(span_slope_bits(config)), "step": lambda: Vector(step_bits(config))}
    # The greatest slope from the light, which is multiplied by distances within the world, and its greatest change.
    limits = [511 * steepest_slope(config)] * 2 + [2 * far << step_bits(config) - 1]
    leaf = leaf_of(
        line_eval,
        config,
        query=lambda: Query(config),
        answer=lambda: Answer(config),
        aim=lambda: Aim(config),
        **directions,
    )
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
    bits = {"axis": 2, "left": column_bits(config), "right": column_bits(config)}
    ports = {"slope": lambda: Vector(span_slope_bits(config)), "step": lambda: Vector(step_bits(config))}
    ends = {"at_left": span_slope_bits(config), "at_right": span_slope_bits(config), "growth": step_bits(config)}
    leaf = leaf_of(operand_ends, config, **bits, **ports, **{name: Signed(width) for name, width in ends.items()})
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
