# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_sequencer`."""

import pytest
from fates import check_control, control_leaf, mask_of
from vectors import any_config, config_id, exact_config

from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.verif.expected import trace_cycles


@pytest.mark.parametrize(
    ("function", "config"),
    [
        (exact_control, exact_config(rectangles=1, reflections=0)),
        (exact_control, exact_config(rectangles=1, reflections=2)),
        (exact_control, exact_config(rectangles=3, reflections=2)),
        (exact_control, exact_config(rectangles=12, reflections=2)),
        (exact_control, exact_config(rectangles=32, reflections=0)),
        (exact_control, exact_config(rectangles=5, reflections=2, patterns=True)),
        (exact_control, exact_config(rectangles=2, reflections=2, materials=True)),
        (ray_sequencer, exact_config(rectangles=2, reflections=1)),
        (ray_sequencer, exact_config(rectangles=12, reflections=2)),
        (ray_sequencer, any_config(rectangles=3, reflections=2, divider_bits=3)),
        (ray_sequencer, any_config(rectangles=12, reflections=2, divider_bits=3)),
        (ray_sequencer, any_config(rectangles=5, reflections=2, divider_bits=1)),
    ],
    ids=config_id,
)
def test_controls(function, config, leaf_of, random):
    """The exact engine's control, and the sequencer of either engine."""
    check_control(control_leaf(leaf_of, function, config), config, random)


@pytest.mark.parametrize(
    ("function", "config"),
    [
        (ray_control, any_config(rectangles=5, reflections=2, divider_bits=1)),
        (exact_control, exact_config(rectangles=5, reflections=2, culling=True)),
    ],
    ids=config_id,
)
def test_fate_is_read_in_one_cycle(function, config, leaf_of, random):
    """The units' fate is right in the cycle that `ray_sequencer` states, and inverted in the cycles before and after.

    This detects a register too many or too few between the units and the control's use of their fate.
    """
    leaf = control_leaf(leaf_of, function, config)
    usable, reflections = list(range(config.rectangles)), config.most_reflections
    held = {"rects_usable": mask_of(usable), "fate_may_hit": mask_of(usable), "picture_reflections": reflections}
    for lost in (None, 0, 1, None):
        behind = [(bounce, index) for bounce in range(reflections + 1) for index in usable if random.random() < 0.5]
        trace = trace_cycles(config, usable, reflections, behind=behind, lost=lost)
        leaf.case({**held, "reset_ray_caster": 1, "enable": 0})
        leaf.case({**held, "reset_ray_caster": 0, "enable": 1})
        towards, alive = (opposite_beside([getattr(cycle, name) for cycle in trace]) for name in ("towards", "alive"))
        for number, cycle in enumerate(trace):
            leaf.case({"fate_any_towards": towards[number], "fate_any_alive": alive[number]})
            # In the first cycle initial_ray is don't care.
            leaf.expect(cycle.steps | {"done": 0}, when=number > 0)
        leaf.case({}, {"done": 1})
    leaf.check(settled=len(trace), spare=True)


def opposite_beside(values: list[int | None]) -> list[int]:
    """Replace each missing bit by the inverse of a neighbouring one."""
    padded = [None, *values, None]
    return [
        value if value is not None else 1 - next((one for one in (before, after) if one is not None), 1)
        for before, value, after in zip(padded, values, padded[2:], strict=False)
    ]
