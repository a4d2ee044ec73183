# SPDX-License-Identifier: MIT
"""Leaf test of `rect_setup`."""

import numpy as np
import pytest
from cull_vectors import culling_designs
from vectors import AXES, any_place, by_axis, named

from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.rtl.common.interfaces import Rects, Vector
from raycaster.rtl.common.records import Facet, Point, Walk, WideRect
from raycaster.rtl.common.widths import WIDE_BITS, exact_slope_bits, wide_walk_bits
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY, rect_setup
from raycaster.verif.expected import sorted_rect

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
    leaf = leaf_of(rect_setup, config, slope=lambda: Vector(exact_slope_bits(config) + 1), **ports)
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
