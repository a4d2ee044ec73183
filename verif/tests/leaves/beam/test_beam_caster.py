# SPDX-License-Identifier: MIT
"""Leaf test of `beam_caster`: whole rows of scenes in which a ray of the row meets mirrors and edges."""

import pytest
from beam_vectors import beam_config, race
from engine_vectors import scene_inputs, usable_of
from hard_scenes import pixel_ports, traced_scene
from vectors import basis_inputs, config_id

from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.hdl.signals import Signed
from raycaster.rtl.beam.beam_caster import beam_caster
from raycaster.rtl.beam.latencies import AIM_LATENCY, beam_latency, start_cycles
from raycaster.rtl.common.records import Pixel
from raycaster.rtl.common.widths import factor_bits
from raycaster.rtl.engine.rect_setup import SETUP_LATENCY
from raycaster.scene import UNTURNED
from raycaster.verif.expected import sorted_rect
from raycaster.verif.random_world import random_basis, random_looks

ALL = {"turn": True, "materials": True, "patterns": True}
"""Every feature of the engine."""


@pytest.mark.slow_sets(
    "beam-tiny48-s1-u1-r3-m1-c8-24",
    "beam-tiny48-s1-u1-r3-m2-c8-400",
    "beam-tiny48-s1-u1-r3-m2-c8-turn-200",
    "beam-tiny48-s1-u1-r5",
    "beam-tiny48-s2-u1-r8-m2-c8-12",
    "beam-tiny48-s2-u1-r8-m2-c8-turn-materials-patterns-12",
    "beam-tiny48-s2-u2-r3",
    "beam-tiny48-s2-u2-r5",
    "beam-vga180",
)
@pytest.mark.parametrize(
    ("config", "lines"),
    [
        (beam_config(screen="tiny", rectangles=1, reflections=0, colour_bits=4), 24),
        (beam_config(screen="tiny", rectangles=3, reflections=1, scale=1), 24),
        # Few rectangles, so that each matters in every pass.
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1), 400),
        (beam_config(screen="tiny", rectangles=8, reflections=2), 12),
        (beam_config(screen="tiny", rectangles=5, reflections=3, scale=1), 60),
        (beam_config(screen="tiny", rectangles=5, reflections=4, scale=1, **ALL), 24),
        (beam_config(screen="tiny", rectangles=5, reflections=4, pixels=2), 24),
        (beam_config(rows=180, rectangles=5, reflections=1), 4),
        (beam_config(screen="tiny", rectangles=3, reflections=2, scale=1, turn=True), 200),
        (beam_config(screen="tiny", rectangles=3, reflections=1, scale=1, materials=True, patterns=True), 24),
        (beam_config(screen="tiny", rectangles=8, reflections=2, **ALL), 12),
        (beam_config(screen="tiny", rectangles=2, reflections=0, scale=1, materials=True, patterns=True), 24),
        (beam_config(screen="tiny", rectangles=1, reflections=0, colour_bits=4, pixels=2), 12),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2), 40),
        (beam_config(rows=180, scale=6, rectangles=5, reflections=1, pixels=2), 4),
        (beam_config(screen="tiny", rectangles=3, reflections=2, pixels=2, turn=True, patterns=True), 24),
    ],
    ids=config_id,
)
def test_beam_caster(config, lines, leaf_of, random):
    leaf = leaf_of(beam_caster, config, row_slope=Signed(factor_bits(config)), pixel=lambda: Pixel(config.port_bits))
    slopes, basis, horizon_row = primary_slopes(config.screen_geometry), UNTURNED, config.screen_geometry.horizon_row
    # If the camera can turn, the rectangles are set up once per lane, and once more.
    sweep = SETUP_LATENCY + config.rectangles - 1
    sweeps = [AIM_LATENCY - 3 + sweep * turn for turn in range(config.pixels + 1)] if config.turn else [0]
    # Run until no column is in flight, whatever the registers started with.
    latency = beam_latency(config)
    leaf.stimulus, fates = [{"reset": 1}] * latency, set()
    flat = [horizon_row + slope for slope in (-3, -1, 1, 3)]
    for number in range(lines):
        if config.turn:
            basis = random_basis(random)
            slopes = primary_slopes(config.screen_geometry, basis)
        row = int(random.choice([0, len(slopes) - 1, *flat, *random.integers(len(slopes), size=4)]))
        if number % 8:
            camera, table, column = race(random, config, slopes[row])
            background, reflections = random.integers(256, size=3), config.reflections
            columns = column + 1 + int(random.integers(4))
            line = slopes[row, : columns + columns % config.pixels]
        else:
            camera, table, background, reflections, _ = traced_scene(random, config, random.permutation(slopes[row]))
            line = slopes[row]
        if config.materials:
            table = random_looks(random, table)
        traced = ExactModel().trace(table, camera, background, line, reflections)
        fates |= {tuple(int(winner[column] >= 0) for winner in traced.winners) for column in range(len(line))}
        held = scene_inputs(camera, table, background, reflections) | (basis_inputs(basis) if config.turn else {})
        held |= {"reset": 0, "start_line": 0, "next_column": 0}
        if number % 16 == 4:
            # Reset ends a line that has begun.
            begun = int(random.integers(config.rectangles + 2))
            leaf.stimulus += [{**held, "start_line": 1}, *[held] * begun, {**held, "reset": 1}, *[held] * latency]
        leaf.stimulus += [{**held, "start_line": 1}, held, held]
        held["row_slope"] = horizon_row - row
        given = {first + 3 + index: index for first in sweeps for index in usable_of(table)}
        for cycle in range(3, start_cycles(config) + int(random.integers(4))):
            rect = sorted_rect(table, given[cycle], "rects_rect", config) if cycle in given else {}
            leaf.case({**held, **rect})
        for colours in traced.colours.reshape(-1, config.pixels, 3):
            leaf.stimulus += [held] * int(random.random() < 0.5 * (config.scale == 1 and number % 8 == 0))
            leaf.expected[leaf.cycle + latency] = pixel_ports(config, *colours)
            leaf.case({**held, "next_column": 1})
        leaf.stimulus += [held] * latency
    assert len(fates) >= config.reflections + 2
    leaf.case({})
    leaf.check(settled=min(leaf.expected), spare=not config.reflections)
