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
from raycaster.golden.random_world import (
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
from raycaster.scene import load_scene
from raycaster.screens import BEAM_SCREENS, SCREENS
from raycaster.verif.seeds import seed

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
            assert not any(bounce.alive[ray] for bounce in trace.bounces[len(path) :])
            if name == "exact":
                met = [set(np.flatnonzero(bounce.met[ray])) for bounce in trace.bounces[: len(path)]]
                assert met == [{0, 1, 2} if stop.met is None else stop.met for stop in path]
            for shading, stop in zip(trace.shadings, path, strict=False):
                shaded[bool(shading.lit[ray]), stop.winner >= 0] += 1
            hits = [stop for stop in path if stop.winner >= 0]
            longest = max(longest, len(hits))
            ended += path[-1] in hits and path[-1].quarters == 0
            patterned += any(table.kinds[stop.winner] for stop in hits)
            in_corners += Counter(len(stop.met) for stop in path if stop.corner)
    assert longest == reflections + 1, "no ray made all its reflections"
    assert min(ended, patterned) > 0, "no ray ended early or met a pattern"
    if name == "exact":
        assert min(shaded[True, True], shaded[False, True]) > 30, "few points in the light or in the dark"
    if world is corner_world:
        # One reflection reaches corners of two planes; two also reach corners of three.
        assert set(in_corners) == set(range(1, min(reflections, 2) + 1)), in_corners
        assert min(in_corners.values(), default=30) >= 30, in_corners


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
def test_divides_by_definition(mode, random):
    """Halves go up, and a quotient that does not fit, perhaps only once it is rounded, overflows."""
    bits = 18 + mode[0]
    corners = [0, 1, 2, 3, 4, 5, 255, 256, 510, 511, 512, 1021, 1022, 1023, 1024, 511 * 511, 512 * 511, (1 << bits) - 1]
    numerators = np.concatenate(
        [corners, random.integers(1 << bits, size=400), random.integers(1 << (bits - 8), size=400)]
    )
    denominators = np.concatenate([[0, 1, 2, 3, 255, 256, 510, 511], random.integers(1, 512, size=20)])
    quotients, overflows = divide(numerators[:, None], denominators, *mode)
    for (i, numerator), (j, denominator) in product(enumerate(numerators.tolist()), enumerate(denominators.tolist())):
        expected = quotient(Fraction(numerator, 2 ** mode[0]), denominator, *mode)
        got = None if overflows[i, j] else Fraction(int(quotients[i, j]), 2 ** mode[0])
        assert got == expected, f"{numerator} / {denominator}"
    assert divide(3, 2, 0, mode[1]) == {"truncate": (1, False), "nearest": (2, False)}[mode[1]]


# Rays of pictures ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", BEAM_SCREENS, ids=str)
def test_a_finer_view_is_the_same_view(place):
    """The ray of pixel (s * row, s * column) at scale s is that of pixel (row, column) at scale 1, s times as long."""
    screen = BEAM_SCREENS[place]
    for scale in range(1, screen.doubling + 1):
        if screen.doubling % scale == 0:
            fine, coarse = (primary_slopes(screen.scaled(one)) for one in (scale, 1))
            assert np.array_equal(fine[::scale, ::scale], scale * coarse)


def test_what_the_seed_model_refuses():
    """A camera that turns, and an unknown rounding."""
    scene = load_scene(MIRROR_ROOM)
    turned = scene.model_copy(update={"camera": scene.camera.model_copy(update={"yaw": 1.0})})
    for model in (SeedModel(), model_of(configure())):
        with pytest.raises(ValueError, match="a design without turn does not draw this scene"):
            model.render(turned, SCREENS["tiny", 48])
    with pytest.raises(ValueError, match="truncate or nearest, not 'up'"):
        divide(1, 1, 0, "up")
