# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that start rays, order their tests and trace them, of both engines."""

import pytest
from engine_vectors import check_ray_unit
from fates import check_control, control_leaf, mask_of
from vectors import any_config, by, check_fetches, config_id, designs, exact_config, slope_inputs, unit_config

from raycaster.golden.rays import primary_slopes
from raycaster.rtl.common.interfaces import Slope
from raycaster.rtl.engine.ray_generator import ray_generator
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.engine.rect_sequencer import rect_sequencer
from raycaster.rtl.exact.exact_control import exact_control
from raycaster.rtl.exact.exact_unit import exact_unit
from raycaster.rtl.seed.ray_control import ray_control
from raycaster.rtl.seed.ray_unit import ray_unit
from raycaster.screens import VIEW_DISTANCE
from raycaster.verif.expected import trace_cycles


@designs(*(
    unit_config(screen=screen, rows=rows, units=units)
    for screen, rows, units in (
        ("vga", 240, 1), ("vga", 240, 5), ("vga", 240, 32), ("vga", 240, 40), ("vga", 240, 320),
        ("vga", 200, 20), ("vga", 200, 64), ("tiny", 48, 1), ("tiny", 48, 16), ("tiny", 48, 64),
    )
))  # fmt: skip
def test_ray_generator(config, leaf_of):
    """Rays of whole rows and columns; some are not loaded, and the previous one must then stay."""
    leaf = leaf_of(ray_generator, config, slope=Slope)
    screen = config.screen_geometry
    rays = {(row, column) for row in (0, 1, screen.horizon_row, screen.rows - 1) for column in range(screen.columns)}
    rays |= {(row, column) for row in range(screen.rows) for column in (0, screen.centre_column, screen.columns - 1)}
    slopes, shown = primary_slopes(screen), None
    for number, (row, column) in enumerate(sorted(rays)):
        place = {"place_row": row, "place_column_offset": column // config.units, "column_base": column % config.units}
        for load in [1] if number % 8 == 0 else [0] if number % 8 == 1 else [0, 1]:
            leaf.case({**place, "steps_screen_to_ray": load}, shown)
            shown = slope_inputs(slopes[row, column], "initial_signs") if load else shown
    assert shown["slope_dx"] == VIEW_DISTANCE
    # The counters stop one past their last value, where nothing may overflow.
    past = {"place_row": screen.rows, "place_column_offset": config.groups, "column_base": config.units - 1}
    leaf.case(past, shown)
    leaf.check(settled=1)


@by(count=[1, 5, 12], rect_cycles=[1, 3, 9])
def test_rect_sequencer(count, rect_cycles, leaf_of, random):
    """All, some or single rectangles; some tests end early, and some sequences with a reset."""
    config = exact_config(rectangles=count)
    leaf, on_port = leaf_of(rect_sequencer, config, wanted=count, rect_cycles=lambda: rect_cycles), {}

    def drive(reset, start, mask, current=None, first=False, early_out=0):
        """Add a cycle in which `current` is on the memory's port."""
        if current is not None:
            on_port[leaf.cycle] = current
        leaf.case({"reset_ray_caster": reset, "start_ray": start, "wanted": mask, "early_out": early_out})
        leaf.expect({"fetched": current is not None, "starting": first}, when=not reset)

    every = (1 << count) - 1
    for number in range(60):
        mask = every if number % 7 == 0 else int(random.integers(1 << count)) & int(random.integers(1 << count))
        if number % 3 == 1:
            mask = 1 << number // 3 % count
        if number % 5 == 0:
            drive(1, 0, mask)
        for _ in range(int(random.integers(1, 3))):
            drive(0, 0, mask)
        drive(0, 1, mask)
        tests = []
        for index in range(count):
            if mask >> index & 1:
                # Some tests end early, in any of their cycles.
                last = int(random.integers(rect_cycles)) if random.random() < 0.3 else rect_cycles - 1
                ends = last < rect_cycles - 1
                tests += [(index, cycle == 0, int(ends and cycle == last)) for cycle in range(last + 1)]
        # Only a reset may come before the end.
        for current, first, early_out in tests[: int(random.integers(len(tests) + 1))] if number % 5 == 4 else tests:
            drive(0, 0, mask, current, first, early_out)
        if number % 5 != 4:
            drive(0, 0, mask)
    outputs = leaf.check(settled=4)
    check_fetches(outputs, on_port, "", settled=4)


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


@designs(
    any_config(rectangles=1, reflections=0, divider_bits=1),
    any_config(rectangles=1, reflections=2, fraction_bits=8, divider_bits=1),
    any_config(rectangles=2, reflections=1, divider_bits=3),
    any_config(rectangles=3, reflections=2, divider_bits=3),
    any_config(rectangles=5, reflections=1, fraction_bits=4, divider_bits=2),
    any_config(rectangles=8, reflections=2, fraction_bits=1, divider_bits=2),
    any_config(rectangles=12, reflections=1, divider_bits=1),
    any_config(rectangles=12, reflections=2, divider_bits=3),
    any_config(rectangles=32, reflections=1, fraction_bits=8, divider_bits=3),
    any_config(rectangles=5, reflections=2, culling=False),
    slow=["seed-vga240-u32-r12", "seed-vga240-u32-r32", "seed-vga240-u32-r8"],
)
def test_ray_control(config, leaf_of, random):
    """Rows of any rectangles and fates, with every number of cycles per rectangle."""
    check_control(control_leaf(leaf_of, ray_control, config), config, random)


FINE = {"reflections": 2, "fraction_bits": 8, "rounding": "nearest", "divider_bits": 2}
LOOKS = {"materials": True, "patterns": True}


@designs(
    any_config(units=32, rectangles=8, reflections=1, divider_bits=1),
    any_config(units=5, rectangles=8, reflections=2, rounding="nearest", divider_bits=3, colour_bits=4),
    any_config(screen="tiny", units=2, rectangles=3, reflections=0, divider_bits=2),
    any_config(units=1, rectangles=8, reflections=2, fraction_bits=1, divider_bits=2, colour_bits=5),
    any_config(units=320, rectangles=7, reflections=2, fraction_bits=4, rounding="nearest", divider_bits=3),
    any_config(units=64, rectangles=8, reflections=1, fraction_bits=4, divider_bits=1, colour_bits=1),
    any_config(screen="tiny", units=16, rectangles=8, **FINE),
    any_config(units=40, rectangles=8, reflections=2, fraction_bits=8, divider_bits=3),
    any_config(units=16, rectangles=8, reflections=2, culling=False),
    any_config(units=16, rectangles=8, reflections=1, materials=True),
    any_config(units=32, rectangles=8, reflections=2, fraction_bits=3, **LOOKS),
    any_config(units=64, rectangles=8, reflections=1, fraction_bits=8, patterns=True),
    any_config(units=16, rectangles=8, reflections=2, **LOOKS, culling=False),
    slow=[
        "seed-tiny48-u16", "seed-vga240-u16-r8-m1-f0t-d2-c8-materials", "seed-vga240-u16-r8-m2-f0t-d2-c8-k0",
        "seed-vga240-u32-r8-m1-f0t-d1-c8", "seed-vga240-u320", "seed-vga240-u40", "seed-vga240-u5",
    ],
    quick=["seed-vga240-u16-r8-m2-f0t-d2-c8-k0-materials-patterns"],
)  # fmt: skip
def test_ray_unit(config, leaf_of, random):
    check_ray_unit(leaf_of(ray_unit, config), config, random, rays=120 if config.fraction_bits == 0 else 40)


ALL = {"turn": True, "materials": True, "patterns": True}


@designs(
    exact_config(units=4, rectangles=8, reflections=1),
    exact_config(units=5, rectangles=8, reflections=2),
    exact_config(screen="tiny", units=2, rectangles=8, reflections=0, colour_bits=1),
    exact_config(units=320, rectangles=8, reflections=2, colour_bits=4),
    exact_config(units=1, rectangles=4, reflections=2),
    exact_config(units=8, rectangles=8, reflections=4),
    exact_config(units=8, rectangles=8, reflections=2, culling=True),
    exact_config(units=4, rectangles=8, reflections=1, turn=True),
    exact_config(units=8, rectangles=8, reflections=2, turn=True),
    exact_config(units=5, rectangles=8, reflections=1, patterns=True),
    exact_config(units=8, rectangles=8, reflections=2, materials=True),
    exact_config(units=5, rectangles=8, reflections=2, **ALL),
    exact_config(units=8, rectangles=8, reflections=4, **ALL),
    exact_config(units=4, rectangles=8, reflections=0, **ALL),
    slow=["exact-vga240-u1-", "exact-vga240-u5"],
)
def test_exact_unit(config, leaf_of, random):
    rays = 500 if config == exact_config(units=5, rectangles=8, reflections=2) else 80
    check_ray_unit(leaf_of(exact_unit, config), config, random, rays)
