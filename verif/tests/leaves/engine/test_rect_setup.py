# SPDX-License-Identifier: MIT
"""Leaf tests of `rect_setup`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import WALK, beam_config, by_screen, direction_ports, flat_tables, number, products
from vectors import AXES, any_place, ports

from raycaster.configuration import Configuration
from raycaster.engines.beam import SETUP_LATENCY
from raycaster.golden.random_world import random_basis, random_looks
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import unsigned
from raycaster.rtl.common.interfaces import Direction, Rects
from raycaster.rtl.common.records import Look, Point, facet_of, growth_of, walk_of
from raycaster.rtl.common.widths import DISTANCE_BITS, exact_slope_bits, walk_bits
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
    """Random lines; a reset ends the last one."""
    count = config.rectangles
    leaf = Leaf(rect_setup, lambda: ports(
        "clk reset start_line", rects=Rects(config), camera=Point(), slope=Direction(exact_slope_bits(config) + 1),
        load=unsigned(count), facet=facet_of(config), growth=growth_of(config), start=walk_of(config), config=config,
        in_adders=in_adders
    ), tmp_path)  # fmt: skip
    stimulus = [{"reset": 1}] * 2
    loads = {}
    for _ in range(12):
        table = random_looks(random, flat_tables(random, count))
        camera = np.array([any_place(random) for _ in AXES])
        held = {f"camera_{axis}": int(value) for axis, value in zip(AXES, camera, strict=True)}
        held |= {"reset": 0, "start_line": 0, "rects_usable": sum(int(one) << i for i, one in enumerate(table.enabled))}
        start = len(stimulus)
        stimulus += [{**held, "start_line": 1}, held, held]
        slope = any_slope(random, config)
        held |= direction_ports("slope", config, slope)
        for index in range(count):
            # The rectangle comes two cycles after it was asked for.
            stimulus.append({**held, **sorted_rect(table, index, "rects_rect", config)})
            loads[start + SETUP_LATENCY + index] = table, index, camera, slope
        stimulus += [held] * (SETUP_LATENCY + int(random.integers(5)))
    # Reset while every stage is busy with the last line.
    end = start + SETUP_LATENCY + min(1, count - 1)
    stimulus[end] = stimulus[end] | {"reset": 1}
    stimulus[end + 1] = stimulus[end + 1] | {"reset": 0}
    loads = {cycle: load for cycle, load in loads.items() if cycle <= end}
    outputs = leaf.run_both(stimulus, settled=2 + SETUP_LATENCY)
    width = walk_bits(config)
    for cycle, output in enumerate(outputs[2:], 2):
        assert output["load"] == (1 << loads[cycle][1] if cycle in loads else 0), cycle
    for cycle, (table, index, camera, slope) in loads.items():
        output = outputs[cycle]
        now, then = (products(table, index, camera, column) for column in (slope, slope + np.array([0, 1, 0])))
        case = cycle, index, camera, table.corners[index].tolist(), slope
        assert output["facet_usable"] == table.enabled[index], case
        assert output["facet_axis"] == table.axes[index], case
        assert number(output["facet_distance"], DISTANCE_BITS) == now["distance"], case
        looks = sorted_rect(table, index, "facet", config)
        assert all(
            output[f"facet_{name}"] == looks[f"facet_{name}"] for name in Look(config.materials, config.patterns).layout
        )
        way_q = output["start_way_q" if config.turn else "facet_way_q"]
        assert number(way_q, width) == now["way_q"], case
        for name in WALK:
            assert number(output[f"start_{name}"], width) == now[name], (name, case)
            if not config.turn:
                assert number(output[f"growth_{name}"], DISTANCE_BITS) == then[name] - now[name], (name, case)


@pytest.mark.parametrize("turn", [False, True])
def test_rect_setup_in_adders(turn, tmp_path, random):
    test_rect_setup(beam_config(screen="tiny", turn=turn), tmp_path, random, in_adders=True)
