# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_sequencer`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from exact_vectors import exact_config
from fates import check_control, control_leaf, mask_of
from vectors import any_config, check, driven

from raycaster.configuration import Configuration
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.verif.expected import trace_cycles


@pytest.mark.parametrize(
    ("function", "config"),
    [
        *(
            (exact_control, exact_config(rectangles=n, reflections=r))
            for n, r in ((1, 0), (1, 2), (3, 2), (12, 2), (32, 0))
        ),
        (exact_control, exact_config(rectangles=5, reflections=2, patterns=True)),
        (exact_control, exact_config(rectangles=2, reflections=2, materials=True)),
        *((ray_sequencer, exact_config(rectangles=n, reflections=r)) for n, r in ((2, 1), (12, 2))),
        *(
            (ray_sequencer, any_config(rectangles=n, reflections=2, divider_bits=b))
            for n, b in ((3, 3), (12, 3), (5, 1))
        ),
    ],
    ids=lambda value: value.name if isinstance(value, Configuration) else value.__name__,
)
def test_controls(function, config, tmp_path, random):
    """The exact engine's control, and the sequencer of either engine."""
    check_control(function, config, tmp_path, random)


@pytest.mark.parametrize(
    ("function", "config"),
    [
        (ray_control, any_config(rectangles=5, reflections=2, divider_bits=1)),
        (exact_control, exact_config(rectangles=5, reflections=2, culling=True)),
    ],
    ids=lambda value: value.name if isinstance(value, Configuration) else value.__name__,
)
def test_fate_is_read_in_one_cycle(function, config, tmp_path, random):
    """The units' fate is right in the cycle that `ray_sequencer` states, and inverted in the cycles before and after.

    This detects a register too many or too few between the units and the control's use of their fate.
    """
    leaf = control_leaf(function, config, tmp_path)
    usable, reflections = list(range(config.rectangles)), config.reflections
    held = {"rects_usable": mask_of(usable), "fate_may_hit": mask_of(usable), "picture_reflections": reflections}
    stimulus, expected = [], []
    for lost in (None, 0, 1, None):
        behind = [(bounce, index) for bounce in range(reflections + 1) for index in usable if random.random() < 0.5]
        trace = trace_cycles(config, usable, reflections, behind=behind, lost=lost)
        stimulus += [{**held, "reset_ray_caster": 1, "enable": 0}, {**held, "reset_ray_caster": 0, "enable": 1}]
        # In the first cycle initial_ray is don't care.
        expected += [None, None, None, *(cycle.steps | {"done": 0} for cycle in trace[1:]), {"done": 1}]
        said = {
            "fate_any_towards": opposite_beside([cycle.towards for cycle in trace]),
            "fate_any_alive": opposite_beside([cycle.alive for cycle in trace]),
        }
        cycles = [dict(zip(said, values, strict=True)) for values in zip(*said.values(), strict=True)]
        stimulus += driven(leaf, [*cycles, {}])
    check(leaf, stimulus, expected, settled=len(trace))


def opposite_beside(values: list[int | None]) -> list[int]:
    """Replace each missing bit by the inverse of a neighbouring one."""
    padded = [None, *values, None]
    return [
        value if value is not None else 1 - next((one for one in (before, after) if one is not None), 1)
        for before, value, after in zip(padded, values, padded[2:], strict=False)
    ]
