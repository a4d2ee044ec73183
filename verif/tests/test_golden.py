# SPDX-License-Identifier: MIT
"""The golden models trace any world as the image contract in `definition.py` says, and rays of finer pictures agree."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from conftest import ROOT
from definition import compare, exact_hit, follow, quotient, seed_hit
from generated import examples, worlds
from hypothesis import given
from hypothesis import strategies as st

from raycaster.configuration import configure
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import count_wrong
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
from raycaster.golden.seed_engine import SeedModel, divide
from raycaster.golden.world import Rectangles
from raycaster.scene import UNTURNED, Camera, load_scene
from raycaster.screens import BEAM_SCREENS, SCREENS
from raycaster.verif.seeds import repeat, seed

MIRROR_ROOM = ROOT / "scenes" / "mirror_room.toml"
BACKGROUND = (7, 80, 201)
RAYS = 40
MODES = {f"{rounding}-{bits}": (bits, rounding) for bits in (0, 1, 4, 8) for rounding in ("truncate", "nearest")}
MODELS = {"exact": (ExactModel(), exact_hit)} | {
    name: (SeedModel(*mode), seed_hit(*mode)) for name, mode in MODES.items()
}


def corner_world(rng):
    """Return a table, a camera and rays that run into corners."""
    corners, camera = random_grid(rng, 10)
    table = Rectangles(corners, rng.integers(256, size=(10, 3)).astype(np.uint8), np.ones(10, dtype=bool))
    slopes = np.where(rng.random((RAYS, 1)) < 0.4, rng.choice([-1, 1], (RAYS, 3)), rng.integers(-2, 3, (RAYS, 3)))
    return table, camera, slopes


def any_world(rng):
    """Return a table, a camera and rays of any kind."""
    table = random_rectangles(rng)
    return table, random_camera(rng, table), random_slopes(rng, RAYS)


def turned_world(rng):
    """Return a table, a camera and rays, half of the time those of a turned camera's picture."""
    table, camera, slopes = any_world(rng)
    if rng.random() < 0.5:
        slopes = primary_slopes(SCREENS["vga", 240], random_basis(rng)).reshape(-1, 3)
        slopes = slopes[rng.integers(len(slopes), size=RAYS)]
    return table, camera, slopes


@pytest.mark.parametrize(
    ("name", "world", "reflections"),
    [
        *product(["exact"], [corner_world, turned_world], [0, 1, 2, 4]),
        # Fewer reflections only blend fewer colours.
        *((name, any_world, reflections) for reflections, name in zip([0, 1, *[2] * 6], MODES, strict=True)),
    ],
)
def test_traces_as_fractions_do(name, world, reflections):
    """Rays meet the same rectangles in the same points and have the same colours, in the light and in the dark."""
    model, hit = MODELS[name]
    rng = np.random.default_rng([seed(), reflections])
    longest, patterned, ended, in_corners, shaded = 0, 0, 0, Counter(), Counter()
    for _ in range(30):
        table, camera, slopes = world(rng)
        if rng.random() < 0.6:
            table = random_looks(rng, table)
        light = random_light(rng, table, camera) if name == "exact" and rng.random() < 0.7 else None
        trace = model.trace(table, camera, BACKGROUND, slopes, reflections, light=light, keep=True)
        for ray, slope in enumerate(slopes.tolist()):
            path = follow(table, BACKGROUND, camera.tolist(), slope, reflections, light, hit)
            compare(trace, ray, path)
            assert not any(bounce.alive[ray] for bounce in trace.bounces[len(path) :]), repeat()
            if name == "exact":
                met = [set(np.flatnonzero(bounce.met[ray])) for bounce in trace.bounces[: len(path)]]
                assert met == [{0, 1, 2} if stop.met is None else stop.met for stop in path], repeat()
            for shading, stop in zip(trace.shadings, path, strict=False):
                shaded[bool(shading.lit[ray]), stop.winner >= 0] += 1
            hits = [stop for stop in path if stop.winner >= 0]
            longest = max(longest, len(hits))
            ended += path[-1] in hits and path[-1].quarters == 0
            patterned += any(table.kinds[stop.winner] for stop in hits)
            in_corners += Counter(len(stop.met) for stop in path if stop.corner)
    assert longest == reflections + 1, f"no ray made all its reflections; {repeat()}"
    assert min(ended, patterned) > 0, f"no ray ended early or met a pattern; {repeat()}"
    if name == "exact":
        assert min(shaded[True, True], shaded[False, True]) > 30, f"few points in the light or in the dark; {repeat()}"
    if world is corner_world:
        # One reflection reaches corners of two planes; two also reach corners of three.
        assert set(in_corners) == set(range(1, min(reflections, 2) + 1)), f"{in_corners}; {repeat()}"
        assert min(in_corners.values(), default=30) >= 30, f"{in_corners}; {repeat()}"


@pytest.mark.parametrize("name", ["exact", "nearest-4"])
def test_kept_values_of_hits_agree_with_each_other(name):
    """The ratio of numerator and denominator is the way to the plane; a depth is a distance along x."""
    rng, exact, hits = np.random.default_rng(seed()), name == "exact", 0
    for table, camera, slopes in (any_world(rng) for _ in range(20)):
        for bounce in MODELS[name][0].trace(table, camera, BACKGROUND, slopes, 2, keep=True).bounces:
            for index in np.flatnonzero(table.visible):
                hit, axis = bounce.hits[index], table.axes[index]
                origins, slope, points = bounce.origins[hit], bounce.slopes[hit], bounce.points[index][hit]
                n, e = bounce.numerators[index][hit], bounce.denominators[index][hit]
                away = (table.low[index, axis] << (0 if exact else 4)) - origins[:, axis]
                assert (n * slope[:, axis] == away * e).all() and (e != 0).all(), repeat()
                far = np.abs(slope[:, 0]) * n if exact else np.abs(points[:, 0] - origins[:, 0])
                assert (bounce.depths[index][hit] == far).all(), repeat()
                assert bounce.valid[index][hit].all(), repeat()
                hits += hit.sum()
    assert hits > 100, repeat()


@examples(100)
@given(worlds(), st.integers(0, 4))
def test_few_coordinates_trace_as_fractions_do(world, reflections):
    """Planes, edges and the camera often coincide; a failing world is shrunk. Nothing is kept on the way."""
    table, camera, slopes = world
    traced = ExactModel().trace(table, camera, BACKGROUND, slopes, reflections)
    assert traced.bounces == ()
    for ray, slope in enumerate(slopes.tolist()):
        compare(traced, ray, follow(table, BACKGROUND, camera.tolist(), slope, reflections))


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_divides_by_definition(mode):
    """Halves go up, and a quotient that does not fit, perhaps only once it is rounded, overflows."""
    rng = np.random.default_rng(seed())
    bits = 18 + mode[0]
    corners = [0, 1, 2, 3, 4, 5, 255, 256, 510, 511, 512, 1021, 1022, 1023, 1024, 511 * 511, 512 * 511, (1 << bits) - 1]
    numerators = np.concatenate([corners, rng.integers(1 << bits, size=400), rng.integers(1 << (bits - 8), size=400)])
    denominators = np.concatenate([[0, 1, 2, 3, 255, 256, 510, 511], rng.integers(1, 512, size=20)])
    quotients, overflows = divide(numerators[:, None], denominators, *mode)
    for (i, numerator), (j, denominator) in product(enumerate(numerators.tolist()), enumerate(denominators.tolist())):
        expected = quotient(Fraction(numerator, 2 ** mode[0]), denominator, *mode)
        got = None if overflows[i, j] else Fraction(int(quotients[i, j]), 2 ** mode[0])
        assert got == expected, f"{numerator} / {denominator}; {repeat()}"
    assert divide(3, 2, 0, mode[1]) == {"truncate": (1, False), "nearest": (2, False)}[mode[1]]


# Rays of pictures ----------------------------------------------------------------------------------------------------


@examples(40)
@given(worlds(), st.integers(1, 256), st.integers(0, 2))
def test_longer_slopes_make_no_difference(world, factor, reflections):
    """A camera that is not turned needs no basis, whose vectors have 256 units."""
    table, camera, slopes = world
    one, other = (
        ExactModel().trace(table, camera, BACKGROUND, rays, reflections) for rays in (slopes, factor * slopes)
    )
    assert np.array_equal(one.winners, other.winners) and np.array_equal(one.colours, other.colours)


@pytest.mark.parametrize("place", BEAM_SCREENS, ids=str)
def test_a_finer_view_is_the_same_view(place):
    """The ray of pixel (s * row, s * column) at scale s is that of pixel (row, column) at scale 1, s times as long."""
    screen = BEAM_SCREENS[place]
    for scale in range(1, screen.doubling + 1):
        if screen.doubling % scale == 0:
            fine, coarse = (primary_slopes(screen.scaled(one)) for one in (scale, 1))
            assert np.array_equal(fine[::scale, ::scale], scale * coarse)


def test_no_ray_leaves_a_closed_room():
    """Edges of the room lie on pixel diagonals."""
    table = Rectangles(np.array(ROOM), np.full((6, 3), 99, dtype=np.uint8), np.ones(6, dtype=bool))
    for basis in (UNTURNED, Camera(position=(0, 0, 0), yaw=45, pitch=45).basis):
        slopes = primary_slopes(SCREENS["vga", 240], basis).reshape(-1, 3)
        assert all(
            (winner >= 0).all() for winner in ExactModel().trace(table, [255] * 3, BACKGROUND, slopes, 4).winners
        )


def test_what_the_seed_model_refuses():
    """A camera that turns, and an unknown rounding."""
    scene = load_scene(MIRROR_ROOM)
    turned = scene.model_copy(update={"camera": scene.camera.model_copy(update={"yaw": 1.0})})
    for model in (SeedModel(), model_of(configure())):
        with pytest.raises(ValueError, match="a design without turn does not draw this scene"):
            model.render(turned, SCREENS["tiny", 48])
    with pytest.raises(ValueError, match="truncate or nearest, not 'up'"):
        divide(1, 1, 0, "up")


@pytest.mark.parametrize("rounding", ["truncate", "nearest"])
def test_comes_close_to_exact_with_more_fraction_bits(rounding):
    """About 1 % of a closed room's pixels are wrong without fraction bits, almost none with eight."""
    scene, screen = load_scene(MIRROR_ROOM), SCREENS["vga", 240]
    reference = ExactModel().render(scene, screen)
    wrong = {bits: count_wrong(SeedModel(bits, rounding).render(scene, screen), reference) for bits in (0, 2, 4, 8)}
    assert wrong[0] > wrong[2] > wrong[4] >= wrong[8], wrong
    shares = [wrong[bits] / (screen.rows * screen.columns) for bits in (0, 4, 8)]
    assert shares[0] > 0 and all(np.array(shares) < [0.02, 0.002, 0.0002]), wrong
