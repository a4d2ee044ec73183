# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_sequencer`: MyHDL and converted Verilog match the expected values on the same vectors."""

from itertools import pairwise

import pytest
from exact_vectors import exact_config
from fates import control_leaf, flat_rectangles, group_fate_in, mask_of, random_fate, usable_masks

from raycaster.configuration import Configuration, configure
from raycaster.golden.random_world import random_looks
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.verif.expected import EARLY_OUT_AT, TraceCycle, ends_early, slot_length, sorted_rect, trace_cycles


def seed_config(**options) -> Configuration:
    return configure(allow_underrun=True, **options)


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
            (ray_sequencer, seed_config(rectangles=n, reflections=2, divider_bits=b))
            for n, b in ((3, 3), (12, 3), (5, 1))
        ),
    ],
    ids=lambda value: value.name if isinstance(value, Configuration) else value.__name__,
)
def test_controls(function, config, tmp_path, random):
    write_at = 2 if config.engine == "exact" else slot_length(config) + 3
    leaf = control_leaf(function, config, tmp_path)
    count = config.rectangles
    masks, table = usable_masks(random, count, 24), flat_rectangles(random, count)
    table = random_looks(random, table)
    quiet = {name: 0 for name in leaf.outputs if name.startswith("steps_") and name != "steps_initial_ray"}
    quiet["done"] = 0
    quiet_cycle = TraceCycle({}, 0)
    stimulus, expected = [], []

    def drive(inputs, wanted=None, current=None, offered=None):
        rect = sorted_rect(table, int(random.integers(count)) if current is None else current, "rects_rect", config)
        stimulus.append({**inputs, **{name: value for name, value in rect.items() if name in leaf.given}})
        expected.append((wanted, current, offered))

    for number, mask in enumerate(masks):
        usable = [index for index in range(count) if mask >> index & 1]
        reflections = config.reflections if number < 2 else int(random.integers(config.reflections + 1))
        held = {"rects_usable": mask, "picture_reflections": reflections}
        fate = random_fate(random, usable, reflections, number)
        # Unusable rectangles are not visited, whatever the mask says.
        held["fate_may_hit"] = mask_of(fate["may_hit"]) | int(random.integers(1 << count)) & ~mask
        for _ in range(2):
            drive({**held, "reset_ray_caster": 1, "enable": int(random.integers(2))})
        for _ in range(int(random.integers(3))):
            drive({**held, "reset_ray_caster": 0, "enable": 0}, quiet)
        drive({**held, "reset_ray_caster": 0, "enable": 1}, quiet)
        trace = trace_cycles(config, usable, reflections, **fate)
        if number == 0:
            assert len(trace) + 3 == config.group_cycles, "including done and the two cycles of reset"
        # A row may be abandoned at any moment; results in flight must not appear later.
        abandoned = number > 4 and number % 2
        for before, cycle in pairwise([quiet_cycle, *trace][: int(random.integers(len(trace))) if abandoned else None]):
            wanted = {name: value for name, value in cycle.steps.items() if name in leaf.outputs} | {"done": 0}
            if cycle.steps["steps_screen_to_ray"]:
                del wanted["steps_initial_ray"]
            inputs = {**held, "reset_ray_caster": 0, "enable": int(random.integers(2))}
            inputs |= (
                {"early_out": int(ends_early(config) and before.towards == 0)} if function is ray_sequencer else {}
            )
            drive(inputs | group_fate_in(random, cycle, leaf), wanted, cycle.current, cycle.offered)
        if not abandoned:
            for _ in range(int(random.integers(1, 4))):
                # Rendering is over, so reflections may change.
                after = {"picture_reflections": int(random.integers(config.reflections + 1))}
                after |= {"reset_ray_caster": 0, "enable": int(random.integers(2))}
                drive({**held, **after}, {**quiet, "done": 1})

    settled = next(cycle for cycle, (_, _, offered) in enumerate(expected) if offered is not None)
    outputs = leaf.run_both(stimulus, settled=settled)
    held_by_memory = None
    for cycle, (output, (wanted, current, offered)) in enumerate(zip(outputs, expected, strict=True)):
        if wanted is not None:
            assert {name: output[name] for name in wanted} == wanted, cycle
        if current is not None:
            assert held_by_memory == current, f"cycle {cycle}: fetched another rectangle"
        if function is ray_sequencer and wanted is not None:
            # Bit i follows find_intersection by i + 1 cycles, unless a reset came between.
            started = [
                outputs[before]["steps_find_intersection"] for before in range(cycle - 1, cycle - write_at - 2, -1)
            ]
            resets = [stimulus[before]["reset_ray_caster"] for before in range(cycle - 1, cycle - write_at - 2, -1)]
            alive = started[: resets.index(1)] if 1 in resets else started
            # A test that ended early is not in flight from the next cycle on.
            for place in range(EARLY_OUT_AT, len(alive)):
                alive[place] &= not stimulus[cycle - 1 - place + EARLY_OUT_AT].get("early_out", 0)
            assert output["in_flight"] == sum(bit << place for place, bit in enumerate(alive)), cycle
        elif offered is not None:
            rect = sorted_rect(table, offered, "offered", config)
            surface = {name: value for name, value in rect.items() if name in output}
            assert {name: output[name] for name in surface} == surface, cycle
        if output["rects_fetch"]:
            held_by_memory = output["rects_index"]


@pytest.mark.parametrize(
    ("function", "config"),
    [
        (ray_control, seed_config(rectangles=5, reflections=2, divider_bits=1)),
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
        stimulus += [{name: value for name, value in cycle.items() if name in leaf.inputs} for cycle in [*cycles, {}]]
    outputs = leaf.run_both(stimulus, settled=len(trace))
    for cycle, wanted in enumerate(expected):
        if wanted is not None:
            assert {name: outputs[cycle][name] for name in wanted} == wanted, cycle


def opposite_beside(values: list[int | None]) -> list[int]:
    """Replace each missing bit by the inverse of a neighbouring one."""
    padded = [None, *values, None]
    return [
        value if value is not None else 1 - next((one for one in (before, after) if one is not None), 1)
        for before, value, after in zip(padded, values, padded[2:], strict=False)
    ]
