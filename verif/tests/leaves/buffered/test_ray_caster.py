# SPDX-License-Identifier: MIT
"""Leaf test of `ray_caster`: pixels of both engines, and the cycle of done.

With culling, a group follows others of its frame, during which its rectangles were tested or not.
"""

from itertools import pairwise

import numpy as np
from engine_vectors import fate_of, scene_inputs, usable_of
from fates import may_hit_mask
from hard_scenes import pixel_word, traced_scene, tracer
from vectors import any_config, basis_inputs, check_fetches, designs

from raycaster.configuration import Configuration
from raycaster.golden.rays import primary_slopes
from raycaster.rtl.buffered.ray_caster import ray_caster
from raycaster.rtl.common.widths import pixel_bits
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY
from raycaster.scene import UNTURNED
from raycaster.verif.expected import TraceCycle, rect_cycles, sorted_rect, trace_cycles
from raycaster.verif.random_world import random_basis


def place_after(config: Configuration, place: tuple[int, int]) -> tuple[int, int]:
    """Return the row and group that follow in a frame."""
    row, offset = place
    return (row, offset + 1) if offset < config.groups - 1 else (row + 1, 0)


def places_before(random: np.random.Generator, config: Configuration, place: tuple[int, int]) -> list[tuple[int, int]]:
    """Pick groups to render before this one: the frame's first, sometimes its second, mostly the group before this.

    The rows in between are abandoned.
    """
    row, offset = place
    before = (row, offset - 1) if offset else (row - 1, config.groups - 1)
    second = [(0, 1)] * int(random.random() < 0.2)
    return [(0, 0), *second, *([before] if random.random() < 0.8 else [])]


def remembered(config: Configuration, cycles: list[TraceCycle], usable: list[int]) -> list[int]:
    """Return the rectangle that the memory shows in each cycle of a trace, in the cycle of done, and in the next.

    The control fetches one for each test and each pass, even if nobody waits for it; if none is left, the lowest.
    """
    queue = [*usable, *[0] * len(cycles)]
    held, blends, indices = 0, 0, []
    for before, cycle in pairwise([None, *cycles]):
        if cycle.current is not None:
            held = cycle.current
        elif blends:
            held = queue[blends - 1]
        elif before is not None and (before.current is not None or before.steps["steps_screen_to_ray"]):
            held = 0
        blends = blends + 1 if cycle.steps["steps_add_colour"] else 0
        indices.append(held)
    # A test of one cycle is over in the cycle of done.
    return [*indices, queue[blends - 1], queue[blends - (rect_cycles(config) > 1)]]


@designs(
    any_config(units=1, rectangles=4, reflections=1, divider_bits=3),
    any_config(units=2, rectangles=8, reflections=2, fraction_bits=4, rounding="nearest", divider_bits=3),
    any_config(units=5, rectangles=5, reflections=1, fraction_bits=1, divider_bits=2, colour_bits=4),
    any_config(engine="exact", units=1, rectangles=4, reflections=2),
    any_config(engine="exact", units=2, rectangles=8, reflections=1),
    any_config(engine="exact", units=5, rectangles=7, reflections=0, colour_bits=4),
    any_config(units=4, rectangles=6, reflections=2, divider_bits=1, culling=False),
    any_config(engine="exact", units=4, rectangles=6, reflections=2, culling=True),
    any_config(units=2, rectangles=6, reflections=2, divider_bits=3, materials=True, patterns=True),
    any_config(units=4, rectangles=5, reflections=2, divider_bits=3, materials=True, culling=False),
    any_config(engine="exact", units=2, rectangles=6, reflections=2, materials=True),
    any_config(engine="exact", units=4, rectangles=6, reflections=1, turn=True, culling=True),
    slow=[
        "exact-vga240-u1-r4-m2", "exact-vga240-u4-r6-m2", "exact-vga240-u5", "seed-vga240-u1-",
        "seed-vga240-u4-r5-m2-f0t-d3-c8-k0", "seed-vga240-u5",
    ],
)  # fmt: skip
def test_ray_caster(config, leaf_of, random):
    leaf = leaf_of(ray_caster, config, pixels=config.units * pixel_bits(config))
    predicts = config.culling and not config.turn
    results, shown, culled = [], {}, 0
    for _ in range((160 if config.engine == "exact" else 80) if config.units == 1 else 12):
        basis = random_basis(random) if config.turn else UNTURNED
        groups = primary_slopes(config.screen_geometry, basis)
        groups = groups.reshape(len(groups), config.groups, config.units, 3)
        last = int(random.integers(1, len(groups))), int(random.integers(config.groups))
        camera, table, background, reflections, _ = traced_scene(random, config, groups[last])
        trace = tracer(config, eye=camera, background=background, reflections=reflections)
        usable = usable_of(table)
        scene = scene_inputs(camera, table, background, reflections) | (basis_inputs(basis) if config.turn else {})
        rects = {index: sorted_rect(table, index, "rects_rect", config) for index in usable}
        following, at_hand = None, 0
        places = [*places_before(random, config, last), last] if config.culling else [last]
        for place in places:
            golden = trace(table, slopes=groups[place])
            fate = fate_of(config, golden, table)
            if predicts and place == following:
                mask = may_hit_mask(config, table, camera, *place)
                fate["may_hit"] = [index for index in usable if mask >> index & 1]
                culled += len(usable) - len(fate["may_hit"])
            held = {**scene, "place_row": place[0], "place_column_offset": place[1]}
            if place == places[0]:
                leaf.case({**held, "reset_ray_caster": 1, "enable": 1})
            leaf.case({**held, **rects.get(at_hand, {}), "reset_ray_caster": 1, "enable": 1})
            leaf.stimulus += [{**held, "reset_ray_caster": 0, "enable": 0}] * int(random.integers(3))
            leaf.case({**held, "reset_ray_caster": 0, "enable": 1})
            cycles = trace_cycles(config, usable, reflections, **fate)
            *indices, at_hand = remembered(config, cycles, usable)
            shown |= {leaf.cycle + number: index for number, index in enumerate(indices) if number}
            for index in indices:
                rect = rects.get(index, {})
                leaf.case({**held, **rect, "reset_ray_caster": 0, "enable": int(random.integers(2))})
            # Within a frame, the cycle of done is the first of a reset.
            leaf.stimulus[-1]["reset_ray_caster"] = int(place != last)
            colours = [pixel_word(config, colour) for colour in golden.colours]
            results.append((leaf.cycle - 1, colours))
            # The first group copies the rectangles; the others test them if they take long enough.
            tests = place != (0, 0) and len(cycles) >= config.rectangles + SETUP_LATENCY
            following = place_after(config, place) if tests else None
        leaf.case({})
        results.append((leaf.cycle - 1, results[-1][1]))
    for cycle, colours in results:
        pixels = sum(colour << pixel_bits(config) * unit for unit, colour in enumerate(colours))
        leaf.expected.setdefault(cycle - 1, {"done": 0})
        leaf.expected[cycle] = {"done": 1, "pixels": pixels}
    outputs = leaf.check(settled=results[0][0])
    check_fetches(outputs, shown, "rects_")
    assert bool(culled) == predicts, "rectangles must be culled exactly if the design predicts"
