# SPDX-License-Identifier: MIT
"""The exact engine against the image contract, written out ray by ray with fractions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from raycaster.golden import exact
from raycaster.golden.random_world import random_camera, random_rectangles, random_slopes
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import Scene
from raycaster.screens import SCREENS
from raycaster.verif.seeds import repeat, seed

TABLES = 30
RAYS = 40
BACKGROUND = (7, 80, 201)


def points_by_definition(corners, enabled, origin, slope):
    """Where a ray meets each rectangle, None for those that it does not meet: (Fraction, Fraction, Fraction)."""
    points = []
    for (first, second), on in zip(corners, enabled, strict=True):
        points.append(None)
        equal = [axis for axis in range(3) if first[axis] == second[axis]]
        if not on or not equal:
            continue
        axis = equal[0]
        n, e = first[axis] - origin[axis], slope[axis]
        if e == 0 or n == 0 or (n > 0) != (e > 0):
            continue
        point = [origin[i] + Fraction(slope[i]) * n / e for i in range(3)]
        if all(min(first[i], second[i]) <= point[i] <= max(first[i], second[i]) for i in range(3) if i != axis):
            points[-1] = (axis, point)
    return points


def follow_by_definition(corners, enabled, camera, slope, reflections):
    """Bounce by bounce: the points and the index of the nearest, -1 for none."""
    origin, slope = [Fraction(c) for c in camera], list(slope)
    path = []
    for _ in range(reflections + 1):
        points = points_by_definition(corners, enabled, origin, slope) if origin else [None] * len(corners)
        depths = {i: abs(met[1][0] - origin[0]) for i, met in enumerate(points) if met}
        # The first of equals is the lower index.
        winner = min(depths, key=depths.get) if depths else -1
        path.append((points, winner))
        if winner < 0:
            origin = None
        else:
            axis, origin = points[winner]
            slope[axis] = -slope[axis]
    return path


def colour_by_definition(colours, winners):
    c = [colours[winner] if winner >= 0 else BACKGROUND for winner in winners]
    if len(c) == 1:
        return c[0]
    if len(c) == 2:
        return tuple((a + b) >> 1 for a, b in zip(*c, strict=True))
    return tuple((2 * a + b + d) >> 2 for a, b, d in zip(*c, strict=True))


@pytest.mark.parametrize("reflections", [0, 1, 2, 5])
def test_traces_as_fractions_do(reflections):
    rng = np.random.default_rng([seed(), reflections])
    deepest = 0
    for table in range(TABLES):
        rectangles, slopes = random_rectangles(rng), random_slopes(rng, RAYS)
        camera = random_camera(rng, rectangles)
        trace = exact.trace(rectangles, camera, BACKGROUND, slopes, reflections, keep=True)
        corners, enabled = rectangles.corners.tolist(), rectangles.enabled.tolist()
        for ray, slope in enumerate(slopes.tolist()):
            context = f"table {table}, ray {ray}: camera {camera.tolist()}, slope {slope}; {repeat()}"
            path = follow_by_definition(corners, enabled, camera.tolist(), slope, reflections)
            winners = [winner for _, winner in path]
            assert [int(winner[ray]) for winner in trace.winners] == winners, context
            for bounce, (points, _) in zip(trace.bounces, path, strict=True):
                assert bounce.hits[:, ray].tolist() == [met is not None for met in points], context
                for index, met in enumerate(points):
                    if met:
                        denominator = int(bounce.denominators[index, ray])
                        stored = [Fraction(int(p), denominator) for p in bounce.points[index, ray]]
                        assert stored == met[1], f"rectangle {index}, {context}"
            deepest = max(deepest, sum(winner >= 0 for winner in winners))
            if reflections <= 2:
                expected = colour_by_definition(rectangles.colours.tolist(), winners)
                assert tuple(trace.colours[ray].tolist()) == tuple(expected), context
    assert deepest == reflections + 1, f"no ray made all its reflections; {repeat()}"


def test_kept_values_agree_with_each_other():
    rng = np.random.default_rng(seed())
    for _ in range(20):
        rectangles, slopes = random_rectangles(rng), random_slopes(rng, 100)
        camera = random_camera(rng, rectangles)
        kept = exact.trace(rectangles, camera, BACKGROUND, slopes, 2, keep=True)
        plain = exact.trace(rectangles, camera, BACKGROUND, slopes, 2)
        assert (kept.colours == plain.colours).all(), repeat()
        assert plain.bounces == ()
        assert (kept.bounces[0].eyes == camera).all(), repeat()
        assert (kept.bounces[0].slopes == slopes).all(), repeat()
        for depth, bounce in enumerate(kept.bounces):
            assert (bounce.winners == kept.winners[depth]).all(), repeat()
            assert (bounce.alive == np.all([winner >= 0 for winner in kept.winners[:depth]], axis=0)).all(), repeat()
            for index in np.flatnonzero(rectangles.visible):
                axis = rectangles.axes[index]
                n, e = bounce.numerators[index], bounce.denominators[index]
                flip = np.where(bounce.slopes[:, axis] < 0, -1, 1)
                assert (e == np.abs(bounce.slopes[:, axis])).all(), repeat()
                plane = rectangles.corners[index, 0, axis]
                # A parallel ray has no parameter, and its numerator is 0.
                assert (n == np.where(e == 0, 0, flip * (plane - bounce.eyes[:, axis]))).all(), repeat()
                ways = bounce.slopes * n[:, None]
                assert (bounce.points[index] == bounce.eyes * e[:, None] + ways).all(), repeat()
                assert (bounce.quotients[index] == np.delete(ways, axis, axis=1)).all(), repeat()
                assert (bounce.depths[index] == np.sign(n) * np.abs(ways[:, 0])).all(), repeat()
            hidden = ~rectangles.visible
            assert not bounce.hits[hidden].any(), repeat()
            assert not bounce.points[hidden].any(), repeat()


@pytest.mark.parametrize("reflections", [0, 1, 2])
def test_renders_as_fractions_do(reflections):
    rng = np.random.default_rng(seed())
    rectangles = random_rectangles(rng, closed=True)
    drawn = np.flatnonzero(rectangles.axes >= 0)
    scene = Scene(
        background=BACKGROUND,
        camera={"position": tuple(random_camera(rng, rectangles).tolist())},
        rect=tuple(
            {
                "corners": tuple(map(tuple, rectangles.corners[i].tolist())),
                "colour": tuple(rectangles.colours[i].tolist()),
            }
            for i in drawn
        ),
    )
    picture = exact.render(scene, SCREENS["tiny", 48], reflections)
    assert picture.shape == (48, 64, 3)
    assert picture.dtype == np.uint8
    corners = rectangles.corners[drawn].tolist()
    colours = rectangles.colours[drawn].tolist()
    for row, column in rng.integers((48, 64), size=(300, 2)).tolist():
        slope = (100, column - 32, 38 - row)
        path = follow_by_definition(corners, [True] * len(drawn), scene.camera.position, slope, reflections)
        expected = colour_by_definition(colours, [winner for _, winner in path])
        assert picture[row, column].tolist() == list(expected), f"row {row}, column {column}; {repeat()}"


@pytest.mark.parametrize(("rows", "horizon"), [(240, 190), (200, 150)])
def test_primary_rays(rows, horizon):
    slopes = primary_slopes(SCREENS["vga", rows])
    assert slopes.shape == (rows, 320, 3)
    assert slopes[0, 0].tolist() == [100, -160, horizon]
    assert slopes[rows - 1, 319].tolist() == [100, 159, -49]
    assert slopes[horizon, 160].tolist() == [100, 0, 0]


def test_reflections_are_the_scenes_unless_given():
    scene = Scene(
        reflections=2,
        camera={"position": (10, 256, 20)},
        rect=({"corners": ((0, 0, 0), (511, 511, 0)), "colour": "#804020"},),
        background="#ffffff",
    )
    screen = SCREENS["tiny", 48]
    pictures = [exact.render(scene, screen, reflections) for reflections in (None, 0, 1, 2)]
    assert (pictures[0] == pictures[3]).all()
    assert [picture[47, 32].tolist() for picture in pictures[1:]] == [
        [0x80, 0x40, 0x20],
        [(0x80 + 0xFF) >> 1, (0x40 + 0xFF) >> 1, (0x20 + 0xFF) >> 1],
        [(0x100 + 0x1FE) >> 2, (0x80 + 0x1FE) >> 2, (0x40 + 0x1FE) >> 2],
    ]


def test_lower_index_wins_a_tie():
    wall = ((100, 0, 0), (100, 511, 511))
    for order in ([0, 1], [1, 0]):
        colours = np.array([(1, 1, 1), (2, 2, 2)], dtype=np.uint8)[order]
        rectangles = Rectangles(np.array([wall, wall]), colours, np.ones(2, dtype=bool))
        assert exact.trace(rectangles, (0, 5, 5), (0, 0, 0), [(100, 0, 0)], 0).colours.tolist() == [colours[0].tolist()]


def test_slope_along_x_must_not_be_0():
    rectangles = Rectangles(
        np.zeros((1, 2, 3), dtype=np.int64), np.zeros((1, 3), dtype=np.uint8), np.ones(1, dtype=bool)
    )
    with pytest.raises(ValueError, match="along x must not be 0"):
        exact.trace(rectangles, (0, 0, 0), (0, 0, 0), [(0, 1, 1)], 0)
