# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_setup`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import WALK, beam_config, by_screen, flat_tables, products
from vectors import any_place, by_axis, check, leaf_of

from raycaster.configuration import Configuration
from raycaster.engines.beam import SETUP_LATENCY
from raycaster.golden.random_world import random_basis, random_looks
from raycaster.golden.rays import primary_slopes
from raycaster.rtl.common.interfaces import Direction
from raycaster.rtl.common.records import Look, Point, growth_of, walk_of
from raycaster.rtl.common.widths import exact_slope_bits
from raycaster.rtl.engine.rect_setup import rect_setup
from raycaster.verif.expected import sorted_rect


def any_slope(random: np.random.Generator, config: Configuration) -> np.ndarray:
    """Pick the slope of a pixel's ray; if the camera can turn, with any basis that the registers can hold."""
    slopes = primary_slopes(config.screen_geometry)
    slope = slopes[int(random.integers(len(slopes))), int(random.integers(slopes.shape[1]))]
    if not config.turn:
        return slope
    return slope @ np.array(random_basis(random), dtype=np.int64)


@by_screen
def test_rect_setup(config, tmp_path, random, in_adders=False):
    """Random lines, with each rectangle unusable in at least one; a reset ends the last line."""
    count, ports = config.rectangles, {"start": lambda: walk_of(config), "growth": lambda: growth_of(config)}
    ports |= {"camera": Point, "slope": lambda: Direction(exact_slope_bits(config) + 1)}
    leaf = leaf_of(rect_setup, tmp_path, config, **ports, load=count, in_adders=in_adders)
    stimulus, loads = [{"reset": 1}] * 2, {}
    for line in range(12):
        table = random_looks(random, flat_tables(random, count))
        if line < count:
            table.enabled[line] = False  # so that each rectangle is unusable at least once
        camera = [any_place(random) for _ in range(3)]
        held = by_axis("camera_", camera) | {"reset": 0, "start_line": 0}
        held["rects_usable"] = sum(int(one) << i for i, one in enumerate(table.enabled))
        start = len(stimulus)
        stimulus += [{**held, "start_line": 1}, held, held]
        slope = any_slope(random, config)
        held |= by_axis("slope_", slope)
        for index in range(count):
            # The rectangle comes two cycles after it was asked for.
            stimulus.append({**held, **sorted_rect(table, index, "rects_rect", config)})
            now, then = (products(table, index, camera, column) for column in (slope, slope + [0, 1, 0]))
            looks = sorted_rect(table, index, "facet", config)
            wanted = {
                f"facet_{name}": looks[f"facet_{name}"] for name in Look(config.materials, config.patterns).layout
            }
            wanted |= {"facet_usable": table.enabled[index], "facet_axis": table.axes[index]}
            wanted |= {"start_way_q" if config.turn else "facet_way_q": now["way_q"]}
            wanted |= {"facet_distance": now["distance"], "load": 1 << index}
            wanted |= {f"start_{name}": now[name] for name in WALK}
            wanted |= {} if config.turn else {f"growth_{name}": then[name] - now[name] for name in WALK}
            loads[start + SETUP_LATENCY + index] = wanted
        stimulus += [held] * (SETUP_LATENCY + int(random.integers(5)))
    # Reset while every stage is busy with the last line.
    end = start + SETUP_LATENCY + min(1, count - 1)
    stimulus[end] = stimulus[end] | {"reset": 1}
    stimulus[end + 1] = stimulus[end + 1] | {"reset": 0}
    expected = [loads.get(cycle, {"load": 0}) if cycle <= end else {"load": 0} for cycle in range(len(stimulus))]
    outputs = check(leaf, stimulus, expected, settled=2 + SETUP_LATENCY)
    assert not any(output["load"] for output in outputs[2 : 2 + SETUP_LATENCY])


@pytest.mark.parametrize("turn", [False, True])
def test_rect_setup_in_adders(turn, tmp_path, random):
    """Products from adders, as the culler has them."""
    test_rect_setup(beam_config(screen="tiny", turn=turn), tmp_path, random, in_adders=True)
