# SPDX-License-Identifier: MIT
"""Leaf tests of `beam_lane`: MyHDL and converted Verilog match the expected values on the same vectors."""

import numpy as np
import pytest
from beam_vectors import beam_config, pixels_of, race, row_ports, row_signals
from hard_scenes import pixel_word
from vectors import config_id, ports

from raycaster.engines.beam import beam_latency
from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import tied
from raycaster.rtl.beam.beam_lane import beam_lane
from raycaster.rtl.common.interfaces import Picture
from raycaster.rtl.common.records import Pixel, camera_of
from raycaster.rtl.common.widths import steepest_slope


@pytest.mark.slow_sets("beam-tiny48-s1", "beam-tiny48-s2-u2-r3-m2-c8-1")
@pytest.mark.parametrize(
    ("config", "first", "lines"),
    [
        # Few rectangles, so that each matters in every pass.
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1), 0, 300),
        (beam_config(screen="tiny", rectangles=3, reflections=4, scale=1), 0, 60),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2), 0, 40),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2), 1, 40),
    ],
    ids=config_id,
)
def test_beam_lane(config, first, lines, tmp_path, random):
    """Rows with set-up products: every column, or every other one from the first or the second on."""
    leaf = Leaf(beam_lane, lambda: ports(
        "clk next_column", enter=tied(0, 1), **row_signals(config), camera=camera_of(config), picture=Picture(),
        pixel=Pixel(config.colour_bits), config=config
    ), tmp_path)  # fmt: skip
    slopes, steepest = primary_slopes(config.screen_geometry), steepest_slope(config)
    spare = steepest - int(abs(slopes[..., 1]).max())
    stimulus, expected = [{"next_column": 0}] * beam_latency(config), {}
    for number in range(lines):
        view = slopes[int(random.integers(len(slopes)))].copy()
        if number % 2:
            # The view of another screen, so that every bit of the slopes matters.
            view[:, 0] = random.integers(1, steepest + 1)
            view[:, 1] += random.integers(-spare, spare + 1)
            view[:, 2] = random.integers(-steepest, steepest + 1)
        camera, table, column = race(random, config, view)
        background = random.integers(256, size=3)
        reflections = config.reflections if number % 4 else int(random.integers(config.reflections))
        line = view[: column + 1 + int(random.integers(4))]
        traced = ExactModel().trace(table, camera, background, line[first :: config.pixels], reflections)
        held, begin = row_ports(config, table, camera, view[first : first + 2])
        held |= {"next_column": 0, "picture_reflections": reflections}
        held["picture_background"] = int.from_bytes(bytes(background.astype(np.uint8)))
        stimulus += [held | cycle for cycle in begin]
        for colour in traced.colours:
            expected[len(stimulus) + beam_latency(config)] = pixel_word(config, colour)
            stimulus.append({**held, "next_column": 1})
        stimulus += [held] * beam_latency(config)
    outputs = leaf.run_both([*stimulus, {}], settled=min(expected))
    for cycle, pixel in expected.items():
        channels = [outputs[cycle][f"pixel_{name}"] for name in ("red", "green", "blue")]
        assert pixels_of(config, channels)[:1] == [pixel], cycle
