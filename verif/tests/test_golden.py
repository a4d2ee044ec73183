# SPDX-License-Identifier: MIT
"""Properties of the golden models in every world: they match the definition in fractions, and invariances hold."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from definition import compare, follow
from generated import World, examples, worlds
from hypothesis import given
from hypothesis import strategies as st

from raycaster.configuration import WORLD_SIZE
from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel
from raycaster.golden.world import Rectangles
from raycaster.screens import BEAM_SCREENS

BACKGROUND = (7, 80, 201)
MIRRORS = st.integers(0, 2)
MODELS = {
    "exact": ExactModel().trace,
    "seed-truncate": SeedModel().trace,
    "seed-nearest": SeedModel(3, "nearest").trace,
}
of_each = pytest.mark.parametrize("trace", MODELS.values(), ids=list(MODELS))


def moved(table: Rectangles, corners: np.ndarray) -> Rectangles:
    """Return the rectangles with other corners."""
    return Rectangles(corners, table.colours, table.enabled)


def assert_equal(one, other) -> None:
    """Assert that all rays meet the same rectangles and have the same colours."""
    assert np.array_equal(np.array(one.winners), np.array(other.winners))
    assert np.array_equal(one.colours, other.colours)


@examples(100)
@given(worlds(), st.integers(0, 4))
def test_exact_traces_as_fractions_do(world, reflections):
    table, camera, slopes = world
    traced = ExactModel().trace(table, camera, BACKGROUND, slopes, reflections)
    for ray, slope in enumerate(slopes.tolist()):
        path = follow(table, BACKGROUND, camera.tolist(), slope, reflections)
        compare(traced, ray, path)


@of_each
@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_lower_index_wins_a_tie(trace, order):
    """The first of two equal rectangles is seen."""
    colours = np.array([(1, 1, 1), (2, 2, 2)], dtype=np.uint8)[order]
    corners = np.array([((100, 0, 0), (100, 511, 511))] * 2)
    traced = trace(Rectangles(corners, colours, np.ones(2, dtype=bool)), (0, 5, 5), BACKGROUND, [(100, 0, 0)], 0)
    assert traced.colours.tolist() == [colours[0].tolist()]


@of_each
@examples(40)
@given(worlds(100, 400), st.tuples(*3 * (st.integers(-100, 111),)), MIRRORS)
def test_moving_the_world_makes_no_difference(trace, world, way, reflections):
    table, camera, slopes = world
    there = trace(moved(table, table.corners + way), camera + way, BACKGROUND, slopes, reflections)
    assert_equal(trace(table, camera, BACKGROUND, slopes, reflections), there)


@of_each
@examples(40)
@given(worlds(), MIRRORS)
def test_mirroring_the_world_makes_no_difference(trace, world, reflections):
    table, camera, slopes = world
    other_way, last = np.array([1, -1, 1]), np.array([0, WORLD_SIZE - 1, 0])
    mirrored = World(moved(table, table.corners * other_way + last), camera * other_way + last, slopes * other_way)
    there = trace(mirrored.rectangles, mirrored.camera, BACKGROUND, mirrored.slopes, reflections)
    assert_equal(trace(table, camera, BACKGROUND, slopes, reflections), there)


@pytest.mark.parametrize("place", BEAM_SCREENS, ids=str)
@examples(10)
@given(worlds(), st.data(), MIRRORS)
def test_a_finer_picture_has_the_coarse_one_in_it(place, world, data, reflections):
    """Pixel (s * row, s * column) at scale s equals pixel (row, column) at scale 1."""
    screen = BEAM_SCREENS[place]
    scales = [scale for scale in range(1, screen.doubling + 1) if screen.doubling % scale == 0]
    row = data.draw(st.integers(0, screen.rows - 1), label="row")
    rows = [
        ExactModel().trace(
            world.rectangles, world.camera, BACKGROUND,
            primary_slopes(screen.scaled(scale))[scale * row, ::scale], reflections,
        )
        for scale in scales
    ]  # fmt: skip
    for coarse, fine in pairwise(rows):
        assert_equal(coarse, fine)
