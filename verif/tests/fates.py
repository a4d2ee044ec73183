# SPDX-License-Identifier: MIT
"""Possible fates of a group's rays, for tests of the blocks that control them."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from vectors import Bench, check_fetches

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.common.interfaces import GroupFate, ShadowPass
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.rtl.engines import buffered_engine_of
from raycaster.verif.expected import EARLY_OUT_AT, TraceCycle, ends_early, rect_cycles, sorted_rect, trace_cycles
from raycaster.verif.random_world import random_looks


def control_leaf(leaf_of: Callable[..., Bench], function: Callable, config: Configuration) -> Bench:
    """Make a leaf of ray_control, exact_control, or the ray_sequencer in either of them."""
    ports: dict[str, Any] = {"fate": lambda: GroupFate(config)}
    if function is ray_sequencer:
        write_at = rect_cycles(config) + 3 if config.facts.divides else 2
        ports |= {"in_flight": write_at + 1, "shadow_pass": ShadowPass, "rect_cycles": lambda: rect_cycles(config)}
    return leaf_of(function, config, **ports)


def usable_masks(random: np.random.Generator, count: int) -> list[int]:
    """Return masks of usable rectangles: all, none, each alone, each with the first, and random ones."""
    every = (1 << count) - 1
    masks = [every, 0, 1, 1 << (count - 1), every]
    masks += [int(random.integers(1 << count)) & int(random.integers(1 << count)) for _ in range(24)]
    return masks + [1 << index for index in range(count)] + [1 | 1 << index for index in range(count)]


def flat_rectangles(random: np.random.Generator, count: int) -> Rectangles:
    """Return random rectangles, all enabled, each with a plane on a random axis."""
    table = Rectangles(
        random.integers(WORLD_SIZE, size=(count, 2, 3)),
        random.integers(256, size=(count, 3)).astype(np.uint8),
        np.ones(count, dtype=bool),
    )
    flat = random.integers(3, size=count)
    table.corners[np.arange(count), 1, flat] = table.corners[np.arange(count), 0, flat]
    return table


def random_fate(random: np.random.Generator, usable: Sequence[int], reflections: int, number: int) -> dict[str, Any]:
    """Return keyword arguments of `trace_cycles`; number 0 is the worst case, in which nothing is culled."""
    if number == 0:
        return {"may_hit": usable, "behind": (), "lost": None}
    share = random.choice([0, 0.3, 0.7, 1])
    return {
        "may_hit": [index for index in usable if random.random() < share],
        "behind": [
            (bounce, index)
            for bounce in range(reflections + 1)
            for index in usable
            if random.random() < random.choice([0, 0.4, 1])
        ],
        "lost": int(random.integers(reflections + 1)) if random.random() < 0.3 else None,
    }


def group_fate_in(random: np.random.Generator, cycle: TraceCycle, leaf: Bench) -> dict[str, int]:
    """Return the outputs of the units in a cycle, random where they are don't care."""
    said = {"fate_any_towards": cycle.towards, "fate_any_alive": cycle.alive}
    return {
        name: int(random.integers(2)) if value is None else value for name, value in said.items() if name in leaf.inputs
    }


def mask_of(indices: Sequence[int]) -> int:
    """Return a mask with a bit set for each index."""
    return sum(1 << index for index in indices)


def in_flight(stimulus: list[dict[str, int]], starts: list[int], cycle: int, width: int) -> int:
    """Return the tests in flight: bit i follows find_intersection by i + 1 cycles, unless a reset came between."""
    before = range(cycle - 1, cycle - width - 1, -1)
    resets = [stimulus[one]["reset_ray_caster"] for one in before]
    alive = [starts[one] for one in before][: resets.index(1) if 1 in resets else width]
    # A test that ended early is not in flight from the next cycle on.
    for place in range(EARLY_OUT_AT, len(alive)):
        alive[place] &= not stimulus[cycle - 1 - place + EARLY_OUT_AT].get("early_out", 0)
    return sum(bit << place for place, bit in enumerate(alive))


def check_control(leaf: Bench, config: Configuration, random: np.random.Generator) -> None:
    """Check the control in rows of random fates, some of which are abandoned."""
    alone = "in_flight" in leaf.seen
    count = config.rectangles
    masks, table = usable_masks(random, count), flat_rectangles(random, count)
    table = random_looks(random, table)
    quiet = {name: 0 for name in leaf.outputs if name.startswith("steps_") and name != "steps_initial_ray"}
    quiet["done"] = 0
    on_port, offers, starts = {}, [], []

    def drive(inputs, wanted=None, cycle: TraceCycle | None = None):
        if cycle is not None and cycle.current is not None:
            on_port[leaf.cycle] = cycle.current
        shown = on_port[leaf.cycle] if leaf.cycle in on_port else int(random.integers(count))
        leaf.case(inputs | sorted_rect(table, shown, "rects_rect", config), wanted)
        offered = cycle.offered if cycle is not None else None
        if offered is not None:
            offers.append(leaf.cycle - 1)
            rect = sorted_rect(table, offered, "offered", config)
            leaf.expect({name: value for name, value in rect.items() if name in leaf.seen})
        starts.append(wanted["steps_find_intersection"] if wanted else 0)

    for number, mask in enumerate(masks):
        usable = [index for index in range(count) if mask >> index & 1]
        reflections = config.most_reflections if number < 2 else int(random.integers(config.most_reflections + 1))
        held = {"rects_usable": mask, "picture_reflections": reflections, "reset_ray_caster": 0}
        fate = random_fate(random, usable, reflections, number)
        # Unusable rectangles are not visited, whatever the mask says.
        held["fate_may_hit"] = mask_of(fate["may_hit"]) | int(random.integers(1 << count)) & ~mask
        for _ in range(2):
            drive({**held, "reset_ray_caster": 1, "enable": int(random.integers(2))})
        for _ in range(int(random.integers(3))):
            drive({**held, "enable": 0}, quiet)
        drive({**held, "enable": 1}, quiet)
        trace = trace_cycles(config, usable, reflections, **fate)
        if number == 0:
            assert len(trace) + 3 == buffered_engine_of(config).group_cycles(config), (
                "including done and the two cycles of reset"
            )
        # A row may be abandoned at any moment; results in flight must not appear later.
        abandoned = number > 4 and number % 2
        last = int(random.integers(len(trace))) if abandoned else None
        for before, cycle in pairwise([TraceCycle({}, 0), *trace][:last]):
            wanted = {name: value for name, value in cycle.steps.items() if name in leaf.outputs} | {"done": 0}
            if cycle.steps["steps_screen_to_ray"]:
                del wanted["steps_initial_ray"]
            inputs = {**held, "enable": int(random.integers(2))}
            if alone:
                inputs["early_out"] = int(ends_early(config) and before.towards == 0)
            drive(inputs | group_fate_in(random, cycle, leaf), wanted, cycle)
        if not abandoned:
            for _ in range(int(random.integers(1, 4))):
                # Rendering is over, so reflections may change.
                after = {"picture_reflections": int(random.integers(config.most_reflections + 1))}
                drive({**held, **after, "enable": int(random.integers(2))}, {**quiet, "done": 1})
    if alone:
        width = leaf.seen["in_flight"].width
        for cycle, wanted in leaf.expected.items():
            if cycle >= width:
                wanted["in_flight"] = in_flight(leaf.stimulus, starts, cycle, width)
    outputs = leaf.check(settled=offers[0], spare=True)
    check_fetches(outputs, on_port, "rects_", settled=offers[0])


def margin_of(config: Configuration) -> int:
    """Return how far outside a rectangle's bounds a primary ray that hits it may pass: rounding moves a coordinate by
    less than one."""
    return 1 if config.engine == "seed" else 0


def may_hit_mask(config: Configuration, table: Rectangles, camera, row: int, offset: int) -> int:
    """Apply the culler's rule to the rays at a group's ends: a bit for each rectangle that they may hit."""
    first = [int(d) for d in primary_slopes(config.screen_geometry)[row, offset * config.units]]
    ends = [first, [first[0], first[1] + config.units, first[2]]]
    margin = margin_of(config)
    mask = 0
    for index in map(int, np.flatnonzero(table.visible)):
        axis = int(table.axes[index])
        low, high = (bound[index].astype(object) - camera for bound in (table.low, table.high))
        n = int(low[axis])
        backs = [end[axis] < 0 for end in ends]
        impossible = n == 0 or all((n < 0) != back for back in backs)
        if backs[0] == backs[1]:
            for u in OTHER_AXES[axis]:
                sign = -1 if backs[0] else 1
                ways = [sign * n * end[u] for end in ends]
                impossible |= all(way < (low[u] - margin) * abs(end[axis]) for way, end in zip(ways, ends, strict=True))
                impossible |= all(
                    way > (high[u] + margin) * abs(end[axis]) for way, end in zip(ways, ends, strict=True)
                )
        mask |= (not impossible) << index
    return mask
