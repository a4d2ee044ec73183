# SPDX-License-Identifier: MIT
"""The golden models draw what `docs/pixel.md` says, as `definition.py` writes it out: any world, and whole scenes."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import fields, replace
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import islice, product
from math import floor

import numpy as np
import pytest
from conftest import ROOT
from definition import compare, exact_hit, follow, quotient, seed_hit

from raycaster.design.decide import configure
from raycaster.golden.engines import model_of
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import WRONG, count_wrong, diff_picture, first_wrong, shown, wrong_pixels
from raycaster.golden.rays import primary_slopes
from raycaster.golden.seed_engine import SeedModel, divide
from raycaster.golden.world import Rectangles
from raycaster.rtl.engines import SPAN
from raycaster.scene import Camera, Scene, load_scene, packaged_scenes
from raycaster.screens import LIST_SCREENS, SCREENS
from raycaster.verif.random_world import (
    random_basis,
    random_camera,
    random_grid,
    random_light,
    random_looks,
    random_rectangles,
    random_slopes,
)
from raycaster.verif.seeds import seed

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
    for _ in range(40):
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


# Scenes ---------------------------------------------------------------------------------------------------------------

PAGE = (ROOT / "docs" / "pixel.md").read_text()

TURNED = {"yaw": 31.0, "pitch": -17.5, "roll": 9.0}


def screen_of_the_page(name: str) -> dict[str, int]:
    """Read a screen's numbers from the page's table."""
    [row] = re.findall(rf"^\| `{name}` \|(.*)\|$", PAGE, re.M)
    names = ("columns", "rows", "centre", "horizon", "distance", "pixels")
    return dict(zip(names, map(int, row.split("|")), strict=True))


def exact_basis(camera: Camera) -> list[list[Decimal]]:
    """Compute the camera's vectors times 256 as the page says, before they are rounded, to 30 digits."""

    def sine(degrees: Decimal) -> Decimal:
        x = degrees % 360 * Decimal("3.14159265358979323846264338327950288419716939937510") / 180
        term = total = x
        for n in range(2, 120, 2):
            term *= -x * x / (n * (n + 1))
            total += term
        return total

    with localcontext(prec=50):
        angles = [Decimal(angle) for angle in (camera.yaw, camera.pitch, camera.roll)]
        (sy, sp, sr), (cy, cp, cr) = (map(sine, each) for each in (angles, [90 - angle for angle in angles]))
        forward = cy * cp, sy * cp, sp
        right = -sy * cr - cy * sp * sr, cy * cr - sy * sp * sr, cp * sr
        up = sy * sr - cy * sp * cr, -cy * sr - sy * sp * cr, cp * cr
        return [[round(256 * part, 30) for part in vector] for vector in (forward, right, up)]


def basis_of(camera: Camera) -> list[list[int]]:
    """Compute the camera's basis as the page says."""
    if not (camera.yaw or camera.pitch or camera.roll):
        return [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    return [[floor(part + Decimal("0.5")) for part in vector] for vector in exact_basis(camera)]


def slope_of(
    screen: dict[str, int], camera: Camera, row: int | Fraction, column: int | Fraction
) -> list[int | Fraction]:
    """Compute a pixel's primary ray as the page says."""
    factors = screen["distance"], column - screen["centre"], screen["horizon"] - row
    return [sum(a * b for a, b in zip(factors, parts, strict=True)) for parts in zip(*basis_of(camera), strict=True)]


def table_of(scene: Scene) -> Rectangles:
    """Return a scene's rectangles with the numbers that the definition gives to looks."""
    kinds = ("plain", "checker", "rows", "columns")
    return replace(
        Rectangles.of_scene(scene),
        mirrors=np.array([int(4 * rectangle.mirror) for rectangle in scene.rect]),
        kinds=np.array([kinds.index(rectangle.pattern) for rectangle in scene.rect]),
    )


@pytest.mark.parametrize("name", re.findall(r"^\| `(\w+=\w+)` \|", PAGE, re.M))
def test_the_table_of_screens(name, random):
    """Each screen has the page's numbers, at every scale, and the monitor's pixels show the rays that the page says."""
    option, value = name.lower().split("=")
    place = ("vga", int(value)) if option == "rows" else next(key for key in LIST_SCREENS if key[0] == value)
    screen, page = (LIST_SCREENS | SCREENS)[place], screen_of_the_page(name)
    found = screen.columns, screen.rows, screen.centre_column, screen.horizon_row, screen.view_distance
    assert tuple(page.values()) == (*found, screen.doubling)
    engine, nowhere = "span" if place in LIST_SCREENS else "seed", Camera(position=(0, 0, 0))
    for scale in SPAN.scales(screen) if engine == "span" else (1,):
        config = configure(engine=engine, screen=place[0], rows=place[1], scale=scale)
        slopes, pixels = primary_slopes(config.screen_geometry), (6 if scale % 3 == 0 else page["pixels"]) // scale
        assert slopes.shape == (page["rows"] * scale, page["columns"] * scale, 3)
        picture = random.integers(256, size=slopes.shape).astype(np.uint8)
        monitor, timing = shown(picture, config), config.screen_geometry
        assert monitor.shape == (timing.vertical.visible, timing.horizontal.visible, 3)
        for line, pixel in random.integers(monitor.shape[:2], size=(9, 2)).tolist():
            row, column = line // pixels, pixel // pixels
            assert monitor[line, pixel].tolist() == picture[row, column].tolist()
            ray = slope_of(page, nowhere, Fraction(row, scale), Fraction(column, scale))
            assert slopes[row, column].tolist() == [scale * part for part in ray]


def test_the_basis_is_rounded_from_exact_values(random):
    """The camera's vectors are those of exact angles; no component is near the middle between two whole numbers."""
    special = [0, 30, 45, 60, 90, 120, 180, 270, 360, 0.01, 89.99]
    for _ in range(300):
        yaw, pitch, roll = (float(random.choice(special) if random.random() < 0.5 else random.random() * 720 - 360)
            for _ in range(3))  # fmt: skip
        exact = exact_basis(Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll))
        rounded = [[floor(part + Decimal("0.5")) for part in vector] for vector in exact]
        assert np.array_equal(Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis, rounded)
        assert all(abs(part % 1 - Decimal("0.5")) > 1e-9 for vector in exact for part in vector)


@pytest.mark.parametrize("name", packaged_scenes())
def test_the_page_says_what_golden_draws(name):
    """Some pixels are compared, with 0 to 4 reflections, from the scene's camera and a turned one."""
    reflections = list(packaged_scenes()).index(name) % 5
    scene = load_scene(packaged_scenes()[name]).model_copy(update={"reflections": reflections})
    table = table_of(scene)
    screen, page = SCREENS["tiny", 48], screen_of_the_page("SCREEN=tiny")
    for camera in (scene.camera, Camera(position=scene.camera.position, **TURNED)):
        shown = scene.model_copy(update={"camera": camera})
        slopes = primary_slopes(screen, camera.basis).reshape(-1, 3)
        chosen = list(range(0, len(slopes), 13))
        trace = ExactModel().trace(
            Rectangles.of_scene(scene), camera.position, scene.background, slopes[chosen], reflections,
            light=scene.light,
        )  # fmt: skip
        assert trace.bounces == ()
        for own, asked in ((reflections, None), (4 - reflections, reflections)):
            picture = ExactModel().render(shown.model_copy(update={"reflections": own}), screen, asked)
            assert np.array_equal(picture.reshape(-1, 3)[chosen], trace.colours), "the scene's unless given"
        for ray, number in enumerate(chosen):
            slope = slope_of(page, camera, *divmod(number, screen.columns))
            compare(trace, ray, follow(table, scene.background, camera.position, slope, reflections, scene.light))


@pytest.mark.parametrize("model", [ExactModel(), SeedModel(1)], ids=lambda one: type(one).__name__)
def test_a_trace_needs_no_order(model, random):
    """Following rays to the end before their colours are computed gives the same pictures, in the light too."""
    mirrors = 3

    class Eager(type(model)):
        def meetings(self, *arguments, **options):
            return iter(list(islice(super().meetings(*arguments, **options), mirrors + 1)))

    eager = Eager(**{one.name: getattr(model, one.name) for one in fields(model)})
    for _ in range(30):
        table, camera, slopes = any_world(random)
        light = random_light(random, table, camera) if isinstance(model, ExactModel) else None
        in_turn, found = (one.trace(table, camera, BACKGROUND, slopes, mirrors, light=light) for one in (model, eager))
        for name in ("colours", "winners", "points", "denominators"):
            assert np.array_equal(getattr(in_turn, name), getattr(found, name)), name


@pytest.mark.parametrize("place", LIST_SCREENS, ids=str)
def test_a_finer_view_is_the_same_view(place):
    """The ray of pixel (s * row, s * column) at scale s is that of pixel (row, column) at scale 1, s times as long."""
    screen = LIST_SCREENS[place]
    for scale in range(1, screen.doubling + 1):
        if screen.doubling % scale == 0:
            fine, coarse = (primary_slopes(screen.scaled(one)) for one in (scale, 1))
            assert np.array_equal(fine[::scale, ::scale], scale * coarse)


def test_what_the_seed_model_refuses():
    """A camera that turns, and an unknown rounding."""
    scene = load_scene(packaged_scenes()["mirror_room"])
    turned = scene.model_copy(update={"camera": scene.camera.model_copy(update={"yaw": 1.0})})
    for model in (SeedModel(), model_of(configure())):
        with pytest.raises(ValueError, match="a design without turn does not draw this scene"):
            model.render(turned, SCREENS["tiny", 48])
    with pytest.raises(ValueError, match="truncate or nearest, not 'up'"):
        divide(1, 1, 0, "up")


# Comparing pictures ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("channels", [0, 1, 2, slice(3)], ids=str)
def test_pictures_are_compared(channels):
    """A pixel is wrong with one or more wrong channels; in the diff it is pink, and all others are dim grey."""
    right = np.array([[(0, 0, 0), (200, 100, 0), (255, 255, 255)], [(9, 9, 9)] * 3], dtype=np.uint8)
    picture = right.copy()
    assert (count_wrong(picture, right), first_wrong(picture, right)) == (0, None)
    for row, column in ((0, 2), (1, 0)):
        picture[row, column, channels] ^= 1
    assert wrong_pixels(picture, right).tolist() == [[False, False, True], [True, False, False]]
    assert (count_wrong(picture, right), first_wrong(picture, right)) == (2, (2, 0))
    diff = diff_picture(picture, right)
    assert diff.dtype == np.uint8
    assert diff.tolist() == [[[0] * 3, [33] * 3, list(WRONG)], [list(WRONG), [3] * 3, [3] * 3]]
    with pytest.raises(ValueError, match=r"different shapes: \(1, 3, 3\) and \(2, 3, 3\)"):
        count_wrong(picture[:1], right)
