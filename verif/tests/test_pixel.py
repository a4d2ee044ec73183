# SPDX-License-Identifier: MIT
"""Compare a renderer written section by section from the page `docs/pixel.md` with the golden models."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from math import floor

import pytest
from conftest import ROOT

from raycaster.configuration import Configuration, configure
from raycaster.golden.engines import model_of
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import PATTERNS, Camera, Rectangle, Scene, load_scene, packaged_scenes
from raycaster.screens import BEAM_SCREENS, SCREENS

PAGE = (ROOT / "docs" / "pixel.md").read_text()

SCENES = (
    "boxes", "corners", "degenerate", "facing_mirrors", "chessboard", "kaleidoscope", "matte_gallery", "pool",
    "rooftops", "stage", "blinds", "shadow_hall",
)  # fmt: skip
TURNED = {"yaw": 31.0, "pitch": -17.5, "roll": 9.0}


# The screen, the primary ray ------------------------------------------------------------------------------------------


def screen_of_the_page(name: str) -> dict[str, int]:
    """Read a screen's numbers from the page's table."""
    [row] = re.findall(rf"^\| `{name}` \|(.*)\|$", PAGE, re.M)
    return dict(zip(("columns", "rows", "centre", "horizon", "distance"), map(int, row.split("|")), strict=True))


def basis_of(camera: Camera) -> list[list[int]]:
    if not (camera.yaw or camera.pitch or camera.roll):
        return [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    angles = [math.radians(angle) for angle in (camera.yaw, camera.pitch, camera.roll)]
    (cy, cp, cr), (sy, sp, sr) = map(math.cos, angles), map(math.sin, angles)
    forward = cy * cp, sy * cp, sp
    right = -sy * cr - cy * sp * sr, cy * cr - sy * sp * sr, cp * sr
    up = sy * sr - cy * sp * cr, -cy * sr - sy * sp * cr, cp * cr
    return [[round(256 * part) for part in vector] for vector in (forward, right, up)]


def slope_of(screen: dict[str, int], camera: Camera, row: int, column: int) -> list[int]:
    factors = screen["distance"], column - screen["centre"], screen["horizon"] - row
    return [sum(a * b for a, b in zip(factors, parts, strict=True)) for parts in zip(*basis_of(camera), strict=True)]


# The world, the hit ---------------------------------------------------------------------------------------------------


def axis_of(rectangle: Rectangle) -> int:
    first, second = rectangle.corners
    return next(axis for axis in range(3) if first[axis] == second[axis])


def others(axis: int) -> list[int]:
    return [one for one in range(3) if one != axis]


def within(rectangle: Rectangle, point: list[Fraction], axis: int) -> bool:
    first, second = rectangle.corners
    return all(min(first[u], second[u]) <= point[u] <= max(first[u], second[u]) for u in others(axis))


class Exact:
    """The page except its last section."""

    def hit(self, rectangle, origin, slope, met):
        """Return t and the hit point, or None if the rectangle is not hit."""
        axis = axis_of(rectangle)
        n, e = rectangle.corners[0][axis] - origin[axis], slope[axis]
        if e == 0 or (n == 0 and (met is None or axis in met)):
            return None
        t = Fraction(n) / e
        point = [o + t * d for o, d in zip(origin, slope, strict=True)]
        return (t, point) if t >= 0 and within(rectangle, point, axis) else None


class Seed:
    """The page's last section."""

    def __init__(self, config: Configuration):
        self.steps, self.nearest = 1 << config.fraction_bits, config.rounding == "nearest"

    def hit(self, rectangle, origin, slope, met):
        """Return the depth and the rounded hit point, or None if the rectangle is not hit."""
        axis = axis_of(rectangle)
        n, e = rectangle.corners[0][axis] - origin[axis], slope[axis]
        if e == 0 or n == 0 or (n < 0) != (e < 0):
            return None
        point = list(origin)
        point[axis] = Fraction(rectangle.corners[0][axis])
        for u in others(axis):
            exact = Fraction(abs(slope[u] * n)) / abs(e) * self.steps
            quotient = Fraction(floor(exact + Fraction(1, 2)) if self.nearest else floor(exact), self.steps)
            if quotient >= 512:
                return None
            point[u] += quotient if slope[u] * n * e >= 0 else -quotient
        return (abs(point[0] - origin[0]), point) if within(rectangle, point, axis) else None


# The reflection, the colours ------------------------------------------------------------------------------------------


def colour_at(rectangle: Rectangle, point: list[Fraction]) -> tuple[int, int, int]:
    u, v = others(axis_of(rectangle))
    iu, iv = floor(point[u] / rectangle.cell), floor(point[v] / rectangle.cell)
    odd = {"plain": 0, "checker": iu + iv, "rows": iv, "columns": iu}[rectangle.pattern] % 2
    return rectangle.colour2 if odd else rectangle.colour


def is_lit(scene: Scene, point: list[Fraction], slope: list[int], axis: int) -> bool:
    light = scene.light.position
    if not (light[axis] - point[axis]) * slope[axis] < 0:
        return False
    for rectangle in scene.rect:
        b = axis_of(rectangle)
        if point[b] == light[b]:
            continue
        t = (rectangle.corners[0][b] - light[b]) / (point[b] - light[b])
        if 0 < t < 1 and within(rectangle, [a + t * (p - a) for a, p in zip(light, point, strict=True)], b):
            return False
    return True


def pixel(engine: Exact | Seed, scene: Scene, slope: list[int]) -> list[int]:
    origin, slope, met = [Fraction(part) for part in scene.camera.position], list(slope), None
    colours, mirrors = [], []
    for _ in range(scene.reflections + 1):
        hits = [engine.hit(rectangle, origin, slope, met) for rectangle in scene.rect]
        nearest = min((hit[0] for hit in hits if hit), default=None)
        if nearest is None:
            colours.append(scene.background)
            mirrors.append(0)
            break
        winner = next(index for index, hit in enumerate(hits) if hit and hit[0] == nearest)
        rectangle, (_, point) = scene.rect[winner], hits[winner]
        axis, colour = axis_of(rectangle), colour_at(rectangle, point)
        if scene.light and not is_lit(scene, point, slope, axis):
            colour = tuple(scene.light.quarters * channel // 4 for channel in colour)
        colours.append(colour)
        mirrors.append(int(4 * rectangle.mirror))
        met = {axis} | (met or set() if point == origin else set())
        origin = point
        slope[axis] = -slope[axis]
    seen = [Fraction(channel) for channel in colours[-1]]
    for own, mirror in zip(reversed(colours[:-1]), reversed(mirrors[:-1]), strict=True):
        seen = [((4 - mirror) * one + mirror * behind) / 4 for one, behind in zip(own, seen, strict=True)]
    return [floor(channel) for channel in seen]


# The tests ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", re.findall(r"^\| `(\w+=\w+)` \|", PAGE, re.M))
def test_the_table_of_screens(name):
    option, value = name.split("=")
    key = ("vga", int(value)) if option == "ROWS" else (value, 48)
    screen = (SCREENS | BEAM_SCREENS)[key]
    found = screen.columns, screen.rows, screen.centre_column, screen.horizon_row, screen.view_distance
    assert tuple(screen_of_the_page(name).values()) == found


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(
    "options",
    [{"engine": "exact"}, {"engine": "seed"}, {"engine": "seed", "fraction_bits": 2, "rounding": "nearest"}],
    ids=lambda options: "-".join(map(str, options.values())),
)
def test_the_page_says_what_golden_draws(name, options):
    """Every seventh pixel of the tiny screen is compared, with 0 to 4 reflections; the exact engine also has lights and
    a turned camera."""
    scene = load_scene(packaged_scenes()[name]).model_copy(update={"reflections": SCENES.index(name) % 5})
    if options["engine"] == "seed":
        scene = scene.model_copy(update={"camera": Camera(position=scene.camera.position), "light": None})
    cameras = [scene.camera]
    if options["engine"] == "exact":
        cameras.append(Camera(position=scene.camera.position, **TURNED))
    config = configure(**options, screen="tiny", turn=options["engine"] == "exact", units=1, rectangles=32,
                       reflections=4, materials=True, patterns=True, allow_underrun=True)  # fmt: skip
    engine = Seed(config) if config.facts.divides else Exact()
    screen = screen_of_the_page("SCREEN=tiny")
    for camera in cameras:
        shown = scene.model_copy(update={"camera": camera})
        slopes = primary_slopes(config.screen_geometry, camera.basis).reshape(-1, 3)
        chosen = list(range(0, len(slopes), 7))
        places = [divmod(number, screen["columns"]) for number in chosen]
        mine = [slope_of(screen, camera, *place) for place in places]
        table = Rectangles.of_scene(shown)
        trace = model_of(config).trace(
            table, camera.position, shown.background, slopes[chosen], shown.reflections, light=shown.light
        )
        drawn = [pixel(engine, shown, slope) for slope in mine]
        assert drawn == trace.colours.tolist(), name


def test_the_scenes_have_what_the_page_is_about():
    scenes = [load_scene(packaged_scenes()[name]) for name in SCENES]
    rectangles = [rectangle for scene in scenes for rectangle in scene.rect]
    assert {rectangle.pattern for rectangle in rectangles} == set(PATTERNS)
    assert len({rectangle.mirror for rectangle in rectangles}) >= 4
    assert any(sum(a == b for a, b in zip(*rectangle.corners, strict=True)) > 1 for rectangle in rectangles)
