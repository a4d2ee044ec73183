# SPDX-License-Identifier: MIT
"""Leaf tests of `ray_control`: MyHDL and converted Verilog match the expected values on the same vectors."""

import pytest
from engine_vectors import any_config
from fates import control_leaf, flat_rectangles, group_fate_in, mask_of, random_fate, usable_masks
from vectors import config_id

from raycaster.rtl.seed.ray_control import ray_control
from raycaster.verif.expected import sorted_rect, step_names, trace_cycles

controls = pytest.mark.parametrize(
    "config",
    [
        any_config(rectangles=rectangles, reflections=reflections, fraction_bits=bits, divider_bits=divider_bits)
        for rectangles, reflections, bits, divider_bits in (
            (1, 0, 0, 1), (1, 2, 8, 1), (2, 1, 0, 3), (3, 2, 0, 3), (5, 1, 4, 2), (8, 2, 1, 2), (12, 1, 0, 1),
            (12, 2, 0, 3), (32, 1, 8, 3),
        )
    ]
    + [any_config(rectangles=5, reflections=2, culling=False)],
    ids=config_id,
)  # fmt: skip


@pytest.mark.slow_sets("seed-vga240-u32-r12", "seed-vga240-u32-r32", "seed-vga240-u32-r8")
@controls
def test_ray_control(config, tmp_path, random):
    leaf = control_leaf(ray_control, config, tmp_path)
    count = config.rectangles
    masks, table = usable_masks(random, count, 6), flat_rectangles(random, count)

    stimulus, expected = [], []

    def drive(inputs, wanted=None, current=None):
        shown = int(random.integers(count)) if current is None else current
        stimulus.append({**inputs, **sorted_rect(table, shown, "rects_rect")})
        expected.append(wanted)

    first_known = None
    for number, mask in enumerate(masks):
        usable = [index for index in range(count) if mask >> index & 1]
        reflections = config.reflections if number < 2 else int(random.integers(config.reflections + 1))
        held = {"rects_usable": mask, "picture_reflections": reflections}
        fate = random_fate(random, usable, reflections, number)
        # Unusable rectangles are not visited, whatever the mask says.
        held["fate_may_hit"] = mask_of(fate["may_hit"]) | int(random.integers(1 << count)) & ~mask
        quiet = ({f"steps_{name}": 0 for name in step_names(config) if name != "initial_ray"} | {"done": 0}, None, None)
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
        for cycle in trace[: int(random.integers(len(trace))) if abandoned else None]:
            wanted = cycle.steps | {"done": 0}
            if cycle.steps["steps_screen_to_ray"]:
                del wanted["steps_initial_ray"]
            if cycle.offered is not None and first_known is None:
                first_known = len(stimulus)
            inputs = {**held, "reset_ray_caster": 0, "enable": int(random.integers(2))}
            inputs |= group_fate_in(random, cycle, leaf)
            drive(inputs, (wanted, cycle.current, cycle.offered), cycle.current)
        if not abandoned:
            for _ in range(int(random.integers(1, 4))):
                wanted = {**quiet[0], "done": 1}
                drive({**held, "reset_ray_caster": 0, "enable": int(random.integers(2))}, (wanted, None, None))

    outputs = leaf.run_both(stimulus, settled=first_known)
    held_by_memory = None
    for cycle, (output, wanted) in enumerate(zip(outputs, expected, strict=True)):
        if wanted is not None:
            signals, current, offered = wanted
            assert {name: output[name] for name in signals} == signals, cycle
            if current is not None:
                assert held_by_memory == current, f"cycle {cycle}: fetched another rectangle"
            if offered is not None:
                rect = sorted_rect(table, offered, "offered")
                assert {name: output[name] for name in rect} == rect, cycle
        if output["rects_fetch"]:
            held_by_memory = output["rects_index"]
