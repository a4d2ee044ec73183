# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_setup`."""

import numpy as np
from beam_vectors import WALK, beam_config, by_screen, flat_tables, products
from vectors import any_place, by, by_axis, named

from raycaster.configuration import Configuration
from raycaster.golden.rays import primary_slopes
from raycaster.rtl.common.interfaces import Vector
from raycaster.rtl.common.records import Look, Point, growth_of
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.engine.rect_setup import SETUP_LATENCY, rect_setup
from raycaster.verif.expected import sorted_rect
from raycaster.verif.random_world import random_basis, random_looks


def any_slope(random: np.random.Generator, config: Configuration) -> np.ndarray:
    """Pick the slope of a pixel's ray; if the camera can turn, with any basis that the registers can hold."""
    slopes = primary_slopes(config.screen_geometry)
    slope = slopes[int(random.integers(len(slopes))), int(random.integers(slopes.shape[1]))]
    if not config.turn:
        return slope
    return slope @ np.array(random_basis(random), dtype=np.int64)


@by_screen
def test_rect_setup(config, leaf_of, random, in_adders=False):
    """Random lines, with each rectangle unusable in at least one; a reset ends the last line."""
    count = config.rectangles
    ports = {"camera": Point, "growth": lambda: growth_of(config), "load": count, "in_adders": in_adders}
    leaf = leaf_of(rect_setup, config, slope=lambda: Vector(exact_slope_bits(config) + 1), **ports)
    leaf.stimulus += [{"reset": 1}] * 2
    for line in range(12):
        table = random_looks(random, flat_tables(random, count))
        if line < count:
            table.enabled[line] = False  # so that each rectangle is unusable at least once
        camera = [any_place(random) for _ in range(3)]
        held = by_axis("camera_", camera) | {"reset": 0, "start_line": 0}
        held["rects_usable"] = sum(int(one) << i for i, one in enumerate(table.enabled))
        start = leaf.cycle + SETUP_LATENCY
        leaf.stimulus += [{**held, "start_line": 1}, held, held]
        slope = any_slope(random, config)
        held |= by_axis("slope_", slope)
        for index in range(count):
            # The rectangle comes two cycles after it was asked for.
            leaf.case({**held, **sorted_rect(table, index, "rects_rect", config)})
            now, then = (products(table, index, camera, column) for column in (slope, slope + [0, 1, 0]))
            looks = sorted_rect(table, index, "", config)
            facet = {name: looks[f"_{name}"] for name in Look(config).layout}
            facet |= {"usable": table.enabled[index], "axis": table.axes[index], "distance": now["distance"]}
            wanted = named("facet", facet) | named("start", {name: now[name] for name in WALK})
            wanted |= {"start_way_q" if config.turn else "facet_way_q": now["way_q"]}
            wanted |= {} if config.turn else {f"growth_{name}": then[name] - now[name] for name in WALK}
            leaf.expected[start + index] = wanted | {"load": 1 << index}
        leaf.stimulus += [held] * (SETUP_LATENCY + int(random.integers(5)))
    # Reset while every stage is busy with the last line.
    end = start + min(1, count - 1)
    leaf.stimulus[end] = leaf.stimulus[end] | {"reset": 1}
    leaf.stimulus[end + 1] = leaf.stimulus[end + 1] | {"reset": 0}
    loads = {cycle: wanted for cycle, wanted in leaf.expected.items() if cycle <= end}
    leaf.expected = {cycle: loads.get(cycle) or {"load": 0} for cycle in range(leaf.cycle)}
    outputs = leaf.check(settled=2 + SETUP_LATENCY)
    assert not any(output["load"] for output in outputs[2 : 2 + SETUP_LATENCY])


@by(turn=[False, True])
def test_rect_setup_in_adders(turn, leaf_of, random):
    """Products from adders, as the culler has them."""
    test_rect_setup(beam_config(screen="tiny", turn=turn), leaf_of, random, in_adders=True)
