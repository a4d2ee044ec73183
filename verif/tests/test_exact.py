# SPDX-License-Identifier: MIT
"""Compare the exact engine's model with the image contract, written out ray by ray with fractions."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from definition import compare, follow, pixel

from raycaster.golden.exact import ExactModel
from raycaster.golden.random_world import (
    ROOM,
    random_basis,
    random_camera,
    random_grid,
    random_light,
    random_looks,
    random_rectangles,
    random_slopes,
)
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import UNTURNED, Camera, Scene
from raycaster.screens import SCREENS
from raycaster.verif.seeds import repeat, seed

TABLES = 30
RAYS = 40
BACKGROUND = (7, 80, 201)


def corner_worlds(rng):
    """Return a table, a camera and rays that run into corners."""
    corners, camera = random_grid(rng, 10)
    table = Rectangles(corners, rng.integers(256, size=(10, 3)).astype(np.uint8), np.ones(10, dtype=bool))
    slopes = np.where(rng.random((RAYS, 1)) < 0.4, rng.choice([-1, 1], (RAYS, 3)), rng.integers(-2, 3, (RAYS, 3)))
    return table, camera, slopes


def anywhere(rng):
    """Return a table, a camera and rays of any kind, including those of a turned camera."""
    table = random_rectangles(rng)
    slopes = random_slopes(rng, RAYS)
    if rng.random() < 0.5:
        basis = random_basis(rng)
        slopes = primary_slopes(SCREENS["vga", 240], basis).reshape(-1, 3)[rng.integers(240 * 320, size=RAYS)]
    return table, random_camera(rng, table), slopes


@pytest.mark.parametrize("reflections", [0, 1, 2, 4])
@pytest.mark.parametrize("world", [corner_worlds, anywhere])
def test_traces_as_fractions_do(world, reflections):
    rng = np.random.default_rng([seed(), reflections])
    longest, patterned, ended, in_corners, shaded = 0, 0, 0, Counter(), Counter()
    for number in range(TABLES):
        table, camera, slopes = world(rng)
        if rng.random() < 0.6:
            table = random_looks(rng, table)
        light = random_light(rng, table, camera) if rng.random() < 0.7 else None
        trace = ExactModel().trace(table, camera, BACKGROUND, slopes, reflections, light=light, keep=True)
        for ray, slope in enumerate(slopes.tolist()):
            context = f"table {number}, ray {ray}: camera {camera.tolist()}, slope {slope}, {light}; {repeat()}"
            path = follow(table, BACKGROUND, camera.tolist(), slope, reflections, light)
            compare(trace, ray, path)
            for bounce, stop in zip(trace.bounces, path, strict=False):
                assert bounce.alive[ray], context
                assert set(np.flatnonzero(bounce.met[ray])) == ({0, 1, 2} if stop.met is None else stop.met), context
            assert not any(bounce.alive[ray] for bounce in trace.bounces[len(path) :]), context
            for shading, stop in zip(trace.shadings, path, strict=False):
                shaded[bool(shading.lit[ray]), stop.winner >= 0] += 1
            longest = max(longest, sum(stop.winner >= 0 for stop in path))
            ended += path[-1].quarters == 0 and path[-1].winner >= 0
            patterned += any(table.kinds[stop.winner] and stop.winner >= 0 for stop in path)
            in_corners += Counter(len(stop.met) for stop in path if stop.corner)
    assert longest == reflections + 1, f"no ray made all its reflections; {repeat()}"
    assert min(shaded[True, True], shaded[False, True]) > TABLES, f"few points in the light or in the dark; {repeat()}"
    assert min(ended, patterned) > 0, f"no ray ended early or met a pattern; {repeat()}"
    if world is corner_worlds:
        # One reflection reaches corners of two planes; two also reach corners of three.
        assert set(in_corners) == set(range(1, min(reflections, 2) + 1)), f"{in_corners}; {repeat()}"
        assert min(in_corners.values(), default=TABLES) >= TABLES, f"{in_corners}; {repeat()}"


def test_kept_values_agree_with_each_other():
    rng = np.random.default_rng(seed())
    for _ in range(20):
        rectangles, slopes = random_rectangles(rng), random_slopes(rng, 100)
        camera = random_camera(rng, rectangles)
        kept = ExactModel().trace(rectangles, camera, BACKGROUND, slopes, 2, keep=True)
        plain = ExactModel().trace(rectangles, camera, BACKGROUND, slopes, 2)
        assert (kept.colours == plain.colours).all(), repeat()
        assert plain.bounces == ()
        assert (kept.bounces[0].origins == camera).all(), repeat()
        assert (kept.bounces[0].slopes == slopes).all(), repeat()
        for depth, bounce in enumerate(kept.bounces):
            assert (bounce.alive == np.all([winner >= 0 for winner in kept.winners[:depth]], axis=0)).all(), repeat()
            for index in np.flatnonzero(rectangles.visible):
                axis = rectangles.axes[index]
                n, e = bounce.numerators[index], bounce.denominators[index]
                flip = np.where(bounce.slopes[:, axis] < 0, -1, 1)
                assert (e == np.abs(bounce.slopes[:, axis])).all(), repeat()
                plane = rectangles.corners[index, 0, axis]
                # A parallel ray has no parameter, and its numerator is 0.
                assert (n == np.where(e == 0, 0, flip * (plane - bounce.origins[:, axis]))).all(), repeat()
                ways = bounce.slopes * n[:, None]
                assert (bounce.points[index] == bounce.origins * e[:, None] + ways).all(), repeat()
                assert (bounce.quotients[index] == np.delete(ways, axis, axis=1)).all(), repeat()
                assert (bounce.depths[index] == np.sign(n) * np.abs(ways[:, 0])).all(), repeat()
            hidden = ~rectangles.visible
            assert not bounce.hits[hidden].any(), repeat()
            assert not bounce.points[hidden].any(), repeat()


@pytest.mark.parametrize("reflections", [0, 1, 2])
@pytest.mark.parametrize("turn", [{}, {"yaw": 130, "pitch": -35.5, "roll": 10}])
def test_renders_as_fractions_do(turn, reflections):
    rng = np.random.default_rng(seed())
    rectangles = random_rectangles(rng, closed=True)
    drawn = np.flatnonzero(rectangles.axes >= 0)
    scene = Scene(
        background=BACKGROUND,
        camera={"position": tuple(random_camera(rng, rectangles).tolist()), **turn},
        rect=tuple(
            {
                "corners": tuple(map(tuple, rectangles.corners[i].tolist())),
                "colour": tuple(rectangles.colours[i].tolist()),
                "mirror": (0.5, 0, 1, 0.25, 0.75)[place % 5],
                **({"pattern": "checker", "colour2": (200, 30, place), "cell": 16} if place % 2 else {}),
            }
            for place, i in enumerate(drawn)
        ),
    )
    picture = ExactModel().render(scene, SCREENS["tiny", 48], reflections)
    assert picture.shape == (48, 64, 3)
    assert picture.dtype == np.uint8
    table = Rectangles.of_scene(scene)
    forward, right, up = (np.array(vector) for vector in scene.camera.basis)
    for row, column in rng.integers((48, 64), size=(300, 2)).tolist():
        slope = (100 * forward + (column - 32) * right + (38 - row) * up).tolist()
        path = follow(table, BACKGROUND, scene.camera.position, slope, reflections)
        assert picture[row, column].tolist() == pixel(path), f"row {row}, column {column}; {repeat()}"


def room_from_its_middle():
    """Return a closed room whose edges lie on pixel diagonals."""
    walls = [{"corners": corners, "colour": (40 * index, 250 - 30 * index, 99)} for index, corners in enumerate(ROOM)]
    return Scene(camera={"position": (255, 255, 255)}, reflections=2, rect=walls)


def test_no_ray_leaves_a_closed_room():
    scene = room_from_its_middle()
    for basis in (UNTURNED, Camera(position=(0, 0, 0), yaw=45, pitch=45).basis):
        slopes = primary_slopes(SCREENS["vga", 240], basis).reshape(-1, 3)
        trace = ExactModel().trace(Rectangles.of_scene(scene), scene.camera.position, BACKGROUND, slopes, 4)
        assert all((winner >= 0).all() for winner in trace.winners)


def test_camera_that_is_not_turned_needs_no_basis():
    scene = room_from_its_middle()
    screen = SCREENS["tiny", 48]
    arguments = Rectangles.of_scene(scene), scene.camera.position, BACKGROUND
    slopes = primary_slopes(screen).reshape(-1, 3)
    plain, times_256 = (ExactModel().trace(*arguments, factor * slopes, 2) for factor in (1, 256))
    assert (plain.colours == times_256.colours).all()
    assert (ExactModel().render(scene, screen, 2).reshape(-1, 3) == plain.colours).all()


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
    pictures = [ExactModel().render(scene, screen, reflections) for reflections in (None, 0, 1, 2)]
    assert (pictures[0] == pictures[3]).all()
    assert [picture[47, 32].tolist() for picture in pictures[1:]] == [
        [0x80, 0x40, 0x20],
        [(0x80 + 0xFF) >> 1, (0x40 + 0xFF) >> 1, (0x20 + 0xFF) >> 1],
        [(0x100 + 0x1FE) >> 2, (0x80 + 0x1FE) >> 2, (0x40 + 0x1FE) >> 2],
    ]
