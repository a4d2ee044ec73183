# SPDX-License-Identifier: MIT
"""`beam_lane`: rows with set-up products: every column, or every other one from the first or the second on."""

import pytest
from beam_vectors import any_view, beam_config, race, row_ports, row_ports_of
from hard_scenes import pixel_ports
from vectors import colour_word, config_id

from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.signals import tied
from raycaster.rtl.beam.beam_lane import beam_lane
from raycaster.rtl.beam.latencies import beam_latency


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
def test_beam_lane(config, first, lines, leaf_of, random):
    leaf = leaf_of(beam_lane, config, enter=lambda: tied(0, 1), **row_ports_of(config))
    slopes, latency = primary_slopes(config.screen_geometry), beam_latency(config)
    leaf.stimulus = [{"next_column": 0}] * latency
    for number in range(leaf.some(lines)):
        view = any_view(random, config) if number % 2 else slopes[int(random.integers(len(slopes)))]
        camera, table, column = race(random, config, view)
        background = random.integers(256, size=3)
        reflections = config.reflections if number % 4 else int(random.integers(config.reflections))
        line = view[: column + 1 + int(random.integers(4))]
        traced = ExactModel().trace(table, camera, background, line[first :: config.pixels], reflections)
        held, begin = row_ports(config, table, camera, view[first : first + 2])
        held |= {"next_column": 0, "picture_reflections": reflections, "picture_background": colour_word(background)}
        leaf.stimulus += [held | cycle for cycle in begin]
        for colour in traced.colours:
            # The pixels that other lanes compute are not connected.
            leaf.expected[leaf.cycle + latency] = pixel_ports(config, colour)
            leaf.case({**held, "next_column": 1})
        leaf.stimulus += [held] * latency
    leaf.case({})
    leaf.check(settled=min(leaf.expected))
