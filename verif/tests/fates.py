# SPDX-License-Identifier: MIT
"""Possible fates of a group's rays, for tests of the blocks that control them."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, unsigned
from raycaster.rtl.common.interfaces import GroupFate, Picture, Rects, ShadowPass, Steps
from raycaster.rtl.common.records import rect_of, surface_of
from raycaster.rtl.engine.ray_sequencer import ray_sequencer
from raycaster.verif.expected import TraceCycle, slot_length


def control_leaf(function: Callable, config: Configuration, directory: Path) -> Leaf:
    """Build a leaf of ray_control, exact_control, or the ray_sequencer in either of them."""
    write_at = slot_length(config) + 3 if config.facts.divides else 2
    arguments = {"offered": partial(rect_of if config.facts.divides else surface_of, config)}
    if function is ray_sequencer:
        arguments = {"in_flight": lambda: unsigned(write_at + 1), "early_out": bit, "shadow_pass": ShadowPass}
    return Leaf(
        function,
        lambda: {
            "clk": bit(),
            "reset_ray_caster": bit(),
            "enable": bit(),
            "picture": Picture(),
            "rects": Rects(config),
            "steps": Steps(),
            "fate": GroupFate(config),
            **{name: make() for name, make in arguments.items()},
            "done": bit(),
            **({"slot_cycles": slot_length(config)} if function is ray_sequencer else {}),
            "config": config,
        },
        directory,
    )


def usable_masks(random: np.random.Generator, count: int, some: int) -> list[int]:
    """Return masks of usable rectangles: all, none, each alone, each with the first, and `some` random ones."""
    every = (1 << count) - 1
    masks = [every, 0, 1, 1 << (count - 1), every]
    masks += [int(random.integers(1 << count)) & int(random.integers(1 << count)) for _ in range(some)]
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


def group_fate_in(random: np.random.Generator, cycle: TraceCycle, leaf: Leaf) -> dict[str, int]:
    """Return the outputs of the units in a cycle, random where they are don't care."""
    said = {"fate_any_towards": cycle.towards, "fate_any_alive": cycle.alive}
    return {
        name: int(random.integers(2)) if value is None else value for name, value in said.items() if name in leaf.inputs
    }


def mask_of(indices: Sequence[int]) -> int:
    """Return a mask with a bit set for each index."""
    return sum(1 << index for index in indices)


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
