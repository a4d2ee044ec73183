# SPDX-License-Identifier: MIT
"""Leaf tests of the blocks that leave out rectangles which no ray of a group may hit."""

from collections.abc import Sequence

import numpy as np
import pytest
from fates import margin_of, may_hit_mask
from vectors import AXES, any_config, any_place, by, by_axis, designs, exact_config, named

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.design.decide import configure
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import OTHER_AXES, Rectangles
from raycaster.hdl.signals import Signed
from raycaster.rtl.common.interfaces import Rects, Vector
from raycaster.rtl.common.records import Point
from raycaster.rtl.common.widths import WIDE_BITS, exact_slope_bits, signed_slope_bits, wide_walk_bits
from raycaster.rtl.cull.group_culler import group_culler
from raycaster.rtl.cull.group_tester import group_tester
from raycaster.rtl.cull.rect_copy import WideRect, rect_copy
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY, Facet, Walk, rect_setup
from raycaster.rtl.engines import buffered_engine_of
from raycaster.verif.expected import sorted_rect
from raycaster.verif.random_world import random_camera, random_rectangles


def culling_config(**options) -> Configuration:
    """Make a design that culls."""
    return any_config(culling=True, **options)


def hit_mask(config: Configuration, table: Rectangles, camera, row: int, offset: int) -> int:
    """Return a mask of the rectangles that the group's primary rays hit in the golden model."""
    slopes = primary_slopes(config.screen_geometry)[row, offset * config.units : (offset + 1) * config.units]
    traced = model_of(config).trace(table, camera, (0, 0, 0), slopes, 0, keep=True)
    return sum(int(hit) << index for index, hit in enumerate(traced.bounces[0].hits.any(axis=1)))


def scenes(random: np.random.Generator, config: Configuration):
    """Yield a camera and a table; all rectangles are enabled and have a plane."""
    while True:
        table = random_rectangles(random, config.rectangles, closed=None if config.rectangles >= 7 else False)
        camera = np.asarray(random_camera(random, table))
        if random.random() < 0.3:
            camera = np.array([any_place(random) for _ in AXES])
        corners = table.corners.copy()
        corners[~table.visible, 1, 0] = corners[~table.visible, 0, 0]
        yield camera, Rectangles(corners, table.colours, np.ones(len(table), dtype=bool))


def with_edges_on_rays(
    random: np.random.Generator, config: Configuration, table: Rectangles, camera, places: Sequence[tuple[int, int]]
) -> Rectangles:
    """Move an edge of many rectangles to, or next to, where an end ray of one of the groups meets their plane.

    places: groups, each as a row and the group's number in the row.
    """
    slopes = primary_slopes(config.screen_geometry)
    corners = table.corners.copy()
    for index in range(len(table)):
        axis = int(table.axes[index])
        row, offset = places[int(random.integers(len(places)))]
        first = [int(d) for d in slopes[row, offset * config.units]]
        end = [first[0], first[1] + int(random.choice([0, config.units - 1, config.units])), first[2]]
        if random.random() < 0.6 and end[axis]:
            u, v = (int(other) for other in random.permutation(OTHER_AXES[axis]))
            met = camera[u] + end[u] * (corners[index, 0, axis] - camera[axis]) // end[axis]
            if random.random() < 0.7:
                # Let this edge alone decide.
                corners[index, :, v] = 0, WORLD_SIZE - 1
            corners[index, random.integers(2), u] = np.clip(met + random.integers(-2, 3), 0, WORLD_SIZE - 1)
    return Rectangles(corners, table.colours, table.enabled)


culling_designs = designs(
    culling_config(),
    culling_config(units=20, rectangles=4, fraction_bits=4, rounding="nearest", rows=200),
    culling_config(units=1, rectangles=3),
    culling_config(units=320, rectangles=2),
    culling_config(screen="tiny", units=16, rectangles=32, divider_bits=3),
    culling_config(engine="exact"),
    culling_config(engine="exact", units=64, rectangles=1),
    culling_config(engine="exact", screen="tiny", units=2, rectangles=9),
)


@by(count=[1, 12, 32], margin=[0, 1])
def test_rect_copy(count, margin, leaf_of, random):
    """Fetches of both readers in any order; the second gets what the first got last, with the margin added."""
    config = exact_config(rectangles=count)
    leaf = leaf_of(rect_copy, config, copy=lambda: Rects(config, rect=WideRect()), margin=margin)
    written, asked = [], []
    for cycle in range(600):
        fetch, index = int(cycle < count or random.random() < 0.3), cycle if cycle < count else random.integers(count)
        # Ask only for rectangles that were fetched long enough ago.
        ask = int(cycle == count + 5 or (cycle > count + 5 and random.random() < 0.7))
        corners = np.array([[any_place(random) for _ in range(3)] for _ in range(2)])
        corners[1, random.integers(3)] = corners[0].copy()[axis := int(random.integers(3))]
        corners[1, axis] = corners[0, axis]
        rect = sorted_rect(Rectangles(corners[None], np.zeros((1, 3), np.uint8), np.ones(1, bool)), 0, "rect")
        del rect["rect_colour"]
        wanted = int(random.integers(count))
        fetches = {"rects_fetch": fetch, "rects_index": index, "copy_fetch": ask, "copy_index": wanted}
        leaf.case(fetches | named("rects", rect))
        further = {"low": -margin, "high": margin}
        written.append(named("copy", {name: rect[name] + further.get(name.rpartition("_")[2], 0) for name in rect}))
        asked.append(wanted if ask else None)
    memory, shown = {}, {}
    for read, wanted in enumerate(asked[:-2]):
        # A rectangle that arrived in the cycle before can be read.
        if read > 1 and leaf.stimulus[read - 2]["rects_fetch"]:
            memory[leaf.stimulus[read - 2]["rects_index"]] = written[read - 1]
        shown = shown if wanted is None else memory[wanted]
        leaf.expected[read + 2] = shown
    leaf.check(settled=count + 8)


P, Q = (1, 0, 1), (2, 2, 0)
"""The axes p and q, indexed by a plane's axis: p is y unless the plane is on y, q is z unless it is on z."""

WALK = ("way_p", "low_p", "high_p", "low_q", "high_q")


def flat_table(random: np.random.Generator, count: int) -> Rectangles:
    """Make a table whose rectangles all have a plane; corners of the world are common."""
    corners = np.array([[[any_place(random) for _ in AXES] for _ in range(2)] for _ in range(count)])
    axis = random.integers(3, size=count)
    corners[np.arange(count), 1, axis] = corners[np.arange(count), 0, axis]
    return Rectangles(corners, np.zeros((count, 3), np.uint8), random.random(count) < 0.8)


def products(table: Rectangles, index: int, camera, slope, margin: int) -> dict[str, int]:
    """Compute the products that cross-multiplication compares, the distance and way_q."""
    axis = int(table.axes[index])
    low, high = (bound[index].astype(object) - camera for bound in (table.low, table.high))
    n, e, p, q = int(low[axis]), int(slope[axis]), P[axis], Q[axis]
    found = {"distance": n, "way_p": n * int(slope[p]), "way_q": n * int(slope[q])}
    for name, u in (("p", p), ("q", q)):
        found |= {f"low_{name}": (int(low[u]) - margin) * e, f"high_{name}": (int(high[u]) + margin) * e}
    return found


@pytest.mark.slow_sets(quick=["seed-tiny48"])
@culling_designs
def test_rect_setup(config, leaf_of, random):
    """Random groups, with each rectangle unusable in at least one; a reset ends the last one."""
    count, slopes, margin = config.rectangles, primary_slopes(config.screen_geometry), int(random.integers(2))
    ports = {"camera": Point, "facet": lambda: Facet(config), "growth": lambda: Walk(WIDE_BITS), "load": count}
    ports |= {"start": lambda: Walk(wide_walk_bits(config)), "rects": lambda: Rects(config, rect=WideRect())}
    leaf = leaf_of(rect_setup, config, slope=lambda: Vector(signed_slope_bits(config)), **ports)
    leaf.stimulus += [{"reset": 1}] * 2
    for line in range(12):
        table = flat_table(random, count)
        if line < count:
            table.enabled[line] = False
        camera = [any_place(random) for _ in range(3)]
        held = by_axis("camera_", camera) | {"reset": 0, "start_line": 0}
        held["rects_usable"] = sum(int(one) << i for i, one in enumerate(table.enabled))
        start = leaf.cycle + SETUP_LATENCY
        leaf.stimulus += [{**held, "start_line": 1}, held, held]
        slope = slopes[int(random.integers(len(slopes))), int(random.integers(slopes.shape[1]))]
        held |= by_axis("slope_", slope)
        for index in range(count):
            # The rectangle comes two cycles after it was asked for.
            rect = sorted_rect(table, index, "rects_rect")
            further = {"low": -margin, "high": margin}
            rect = {name: value + further.get(name.rpartition("_")[2], 0) for name, value in rect.items()}
            leaf.case({**held, **{name: value for name, value in rect.items() if not name.endswith("colour")}})
            now, then = (products(table, index, camera, column, margin) for column in (slope, slope + [0, 1, 0]))
            facet = {"usable": table.enabled[index], "axis": table.axes[index], "distance": now["distance"]}
            wanted = named("facet", facet | {"way_q": now["way_q"]}) | named(
                "start", {name: now[name] for name in WALK}
            )
            wanted |= {f"growth_{name}": then[name] - now[name] for name in WALK}
            leaf.expected[start + index] = wanted | {"load": 1 << index}
        leaf.stimulus += [held] * (SETUP_LATENCY + int(random.integers(5)))
    # Reset while every stage is busy with the last group.
    end = start + min(1, count - 1)
    leaf.stimulus[end] = leaf.stimulus[end] | {"reset": 1}
    leaf.stimulus[end + 1] = leaf.stimulus[end + 1] | {"reset": 0}
    loads = {cycle: wanted for cycle, wanted in leaf.expected.items() if cycle <= end}
    leaf.expected = {cycle: loads.get(cycle) or {"load": 0} for cycle in range(leaf.cycle)}
    outputs = leaf.check(settled=2 + SETUP_LATENCY)
    assert not any(output["load"] for output in outputs[2 : 2 + SETUP_LATENCY])


@pytest.mark.slow_sets(quick=["exact-vga240-u64", "seed-tiny48"])
@culling_designs
def test_group_tester_at_its_limits(config, leaf_of, random):
    """Any products, with each comparison decided by its last bit, another single bit, or the sign."""
    slopes_of = dict.fromkeys(("column_slope", "row_slope"), Signed(signed_slope_bits(config)))
    ports = {"facet": lambda: Facet(config), "growth": lambda: Walk(WIDE_BITS)}
    ports |= {"start": lambda: Walk(wide_walk_bits(config)), "load": config.rectangles}
    leaf = leaf_of(group_tester, config, **ports, **slopes_of)
    units, far = config.units, 1 << wide_walk_bits(config) - 2
    slope_limit = 1 << exact_slope_bits(config) - 1
    # The first load makes all registers known.
    leaf.case({"load": (1 << config.rectangles) - 1})
    expected = {}

    def small() -> int:
        return int(random.choice([0, 1, 2, 1 << int(random.integers(far.bit_length() - 3))]) * random.choice([-1, 1]))

    for _ in range(leaf.some(6000)):
        axis = int(random.integers(3))
        distance = int(random.choice([0, 1, -1, 1 << int(random.integers(9)), *random.integers(-511, 512, size=4)]))
        turning = [0, -1, -units, 1 - units, -units - 1]
        column_slope, row_slope = (
            int(np.clip(random.choice([*turning, *random.integers(-slope_limit, slope_limit, size=15)]), -far, far))
            for _ in range(2)
        )
        column_slope, row_slope = max(-slope_limit, column_slope), max(-slope_limit, row_slope)
        slopes = {0: (1, 1), 1: (column_slope, column_slope + units), 2: (row_slope, row_slope)}[axis]
        backs = [slope < 0 for slope in slopes]
        if random.random() < 0.9:
            # Put the plane ahead, so that the bounds decide.
            distance = (-1 if backs[0] else 1) * max(1, abs(distance))
        start = {"way_p": int(random.integers(-far // 4, far // 4)), "way_q": int(random.integers(-far // 4, far // 4))}
        growth = {"way_p": int(random.integers(-far // 8, far // 8)) // units % 512 - 256}
        growth["way_p"] = growth["way_p"] if abs(growth["way_p"]) * units < far // 8 else 0
        # All bounds are far away on their side, except the deciding one, which is near at one end or both.
        low, high = ("high", "low") if backs[0] else ("low", "high")
        for p in "pq":
            start |= {f"{low}_{p}": -far // 2, f"{high}_{p}": far // 2}
            growth |= {f"{low}_{p}": 0, f"{high}_{p}": 0}
        side, p = str(random.choice(["low", "high"])), str(random.choice(["p", "q"]))
        more = int(random.choice([0, 0, 1, -1, small() % 64 - 32]))
        apart = small() - int(random.integers(2)) * more * units
        start[f"{side}_{p}"] = start[f"way_{p}"] + apart
        growth[f"{side}_{p}"] = growth.get(f"way_{p}", 0) + more
        end = {name: value + growth.get(name, 0) * units for name, value in start.items()}
        impossible = distance == 0 or all((distance < 0) != back for back in backs)
        if backs[0] == backs[1]:
            for p in "pq":
                impossible |= all(at[f"way_{p}"] < at[f"{low}_{p}"] for at in (start, end))
                impossible |= all(at[f"way_{p}"] > at[f"{high}_{p}"] for at in (start, end))
        inputs = {"facet_axis": axis, "facet_distance": distance, "facet_way_q": start.pop("way_q")}
        inputs |= {"column_slope": column_slope, "row_slope": row_slope}
        inputs |= named("start", start) | named("growth", growth)
        index = leaf.cycle % config.rectangles
        expected[leaf.cycle + 2] = index, not impossible
        leaf.case({**inputs, "load": 1 << index})
    leaf.stimulus += [{"load": 0}] * 2
    outputs = leaf.check(settled=3)
    for cycle, (index, may_hit) in expected.items():
        assert outputs[cycle]["may_hit"] >> index & 1 == may_hit, leaf.stimulus[cycle - 2]


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
    if not config.facts.whole_frames:
        # The worst case is the same with and without culling.
        cycles = buffered_engine_of(config).group_cycles
        assert cycles(config) == cycles(configure(**{**options, "culling": None}))


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
