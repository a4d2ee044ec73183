# SPDX-License-Identifier: MIT
"""Leaf tests of `group_culler`."""

from collections.abc import Sequence

import numpy as np
import pytest
from cull_vectors import culling_designs, hit_mask, scenes, with_edges_on_rays
from fates import margin_of, may_hit_mask
from vectors import by_axis

from raycaster.configuration import WORLD_SIZE, Configuration, ConfigurationError
from raycaster.design.decide import configure
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.rtl.cull.group_culler import group_culler
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY
from raycaster.rtl.engines import engine_of
from raycaster.verif.expected import sorted_rect


@pytest.mark.parametrize(
    ("options", "culls", "name"),
    [
        ({}, True, "seed-vga240-u32-r12-m1-f0t-d1-c8"),
        ({"culling": "0"}, False, "seed-vga240-u32-r12-m1-f0t-d1-c8-k0"),
        ({"engine": "exact"}, False, "exact-vga240-u4-r12-m1-c8"),
        ({"engine": "exact", "culling": "1"}, True, "exact-vga240-u4-r12-m1-c8-k1"),
        ({"engine": "span"}, False, "span-vga240-s2-u1-r12-m1-l57600-c8"),
    ],
)
def test_which_designs_cull(options, culls, name):
    config = configure(**options)
    assert config.culling is culls
    assert config.name == name
    # The worst case is the same with and without culling.
    cycles = engine_of(config).group_cycles
    assert cycles(config) == cycles(configure(**{**options, "culling": None}))


def test_the_span_engine_does_not_cull():
    with pytest.raises(ConfigurationError, match=r"^culling: the span engine has no groups of columns; leave it out"):
        configure(engine="span", culling="1")


def any_rect(random: np.random.Generator, table: Sequence[dict[str, int]]) -> dict[str, int]:
    """Return random values for the table's port, to be ignored unless they were fetched."""
    shown, index = (int(random.integers(len(table))) for _ in range(2))
    return {**table[shown], "rects_index": index}


def closest_calls(
    config: Configuration, drafts: Sequence[Rectangles], camera, places: Sequence[tuple[int, int]]
) -> Rectangles:
    """Pick for each rectangle the draft whose result an error in a product's lowest bits changes most easily.

    All drafts have the same planes.
    """
    slopes, margin = primary_slopes(config.screen_geometry), margin_of(config)
    first = np.array([slopes[row, offset * config.units] for row, offset in places]).astype(int)
    ends = np.stack([first, first + [0, config.units, 0]])
    corners = []
    for index, axis in enumerate(drafts[0].axes):
        u = list(OTHER_AXES[axis])
        e, across = ends[..., [axis]], ends[..., u]
        distances = []
        for draft in drafts:
            way = np.sign(e) * (draft.low[index, axis] - camera[axis]) * across
            above = way - (draft.low[index, u] - margin - camera[u]) * abs(e)
            below = (draft.high[index, u] + margin - camera[u]) * abs(e) - way
            # For each bound, the end that misses it by less; of the bounds, the deciding one, if it decides alone.
            least, other, *_ = np.sort(np.concatenate([above.max(axis=0), below.max(axis=0)], axis=1), axis=1).T
            distances.append(np.where(other >= 0, abs(least), WORLD_SIZE**2).min())
        corners.append(drafts[int(np.argmin(distances))].corners[index])
    return Rectangles(np.array(corners), drafts[0].colours, drafts[0].enabled)


def any_start(random: np.random.Generator, rows: int, groups: int) -> tuple[int, int]:
    """Pick a group other than the frame's first; often one that differs by a single bit, or at the end of a row."""
    while True:
        # The last rows are those below the horizon.
        any_row, last_row = random.integers(rows), rows - 1 - random.integers(rows // 4)
        row = random.choice([0, 1 << int(random.integers(rows.bit_length())), any_row, last_row, last_row])
        offset = random.choice([0, groups - 1, 1 << int(random.integers(groups.bit_length())), random.integers(groups)])
        if 0 < row * groups + offset < rows * groups and offset < groups:
            return int(row), int(offset)


@pytest.mark.slow_sets("seed-vga240-u1-", "seed-vga240-u320")
@culling_designs
def test_group_culler(config, leaf_of, random):
    """A frame's first group, then others in order and out of order, with enough or too little time to look ahead."""
    leaf = leaf_of(group_culler, config)
    count, groups, rows = config.rectangles, config.groups, config.screen_geometry.rows
    every, fates = (1 << count) - 1, set()

    # Faults are planted in the design with one unit; the others show that other sizes work too.
    some = leaf.some(1500 if config.units == 1 else 200)
    for (camera, drawn), _ in zip(scenes(random, config), range(max(6, some // count)), strict=False):
        start = any_start(random, rows, groups)
        first = start[0] * groups + start[1]
        run = [divmod(number, groups) for number in range(first, min(first + 9, rows * groups))]
        drafts = [with_edges_on_rays(random, config, drawn, camera, run) for _ in range(8)]
        table = closest_calls(config, drafts, camera, run)
        shown = [sorted_rect(table, index, "rects_rect") for index in range(count)]
        quiet = by_axis("camera_", camera) | {"reset_ray_caster": 0, "start_group": 0, "done": 0, "rects_fetch": 0}
        place, predicted, known = (0, 0), None, False
        for number in range(12):
            here = {**quiet, "place_row": place[0], "place_column_offset": place[1]}
            answer = may_hit_mask(config, table, camera, *place) if predicted == place else every
            assert hit_mask(config, table, camera, *place) & ~answer == 0
            fates.add((known, predicted == place, answer == every))
            # The second cycle of reset, then the group; its answer holds until the first cycle of the next reset.
            leaf.case({**here, "reset_ray_caster": 1})
            begun = leaf.cycle
            leaf.stimulus += [here, {**here, "start_group": 1}]
            for index in range(count) if number == 0 else ():
                leaf.case({**here, **any_rect(random, shown), "rects_fetch": 1, "rects_index": index})
                leaf.case({**here, **any_rect(random, shown), **shown[index]})
            time = count + SETUP_LATENCY + int(random.integers(3))
            if random.random() < 0.05:
                time = int(random.integers(3, count + SETUP_LATENCY))
            # Values on the table's port that were not fetched must be ignored.
            leaf.stimulus += [{**here, **any_rect(random, shown)} for _ in range(time - 1)]
            # A frame that is abandoned before its first group is done leaves no rectangles known.
            abandoned = random.random() < 0.05
            leaf.case({**here, "reset_ray_caster": 1, "done": int(not abandoned)})
            leaf.expected |= {cycle: {"may_hit": answer} for cycle in range(begun, leaf.cycle)}

            following = (place[0], place[1] + 1) if place[1] < groups - 1 else (place[0] + 1, 0)
            predicted = following if known and time >= count + SETUP_LATENCY else None
            known = known or (number == 0 and not abandoned)
            place = following
            if abandoned or place[0] == rows:
                place = any_start(random, rows, groups) if random.random() < 0.5 else run[random.integers(len(run))]
            if number == 1:
                # Jump to just before the groups with the rectangles' edges.
                place = start[0] if start[1] else start[0] - 1, (start[1] - 1) % groups
                place = (1, 0) if place == (0, 0) else place
    leaf.check(settled=min(leaf.expected))
    assert {(True, True, False), (True, False, True), (False, False, True)} <= fates
