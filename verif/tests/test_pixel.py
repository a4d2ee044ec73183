# SPDX-License-Identifier: MIT
"""Compare the golden models in whole scenes with the page `docs/pixel.md`: screens, primary rays, the definition."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT
from definition import compare, follow

from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.golden.world import Rectangles
from raycaster.scene import PATTERNS, Camera, Scene, load_scene, packaged_scenes
from raycaster.screens import BEAM_SCREENS, SCREENS

PAGE = (ROOT / "docs" / "pixel.md").read_text()

SCENES = (
    "boxes", "corners", "degenerate", "facing_mirrors", "chessboard", "kaleidoscope", "matte_gallery", "pool",
    "rooftops", "stage", "blinds", "shadow_hall",
)  # fmt: skip
TURNED = {"yaw": 31.0, "pitch": -17.5, "roll": 9.0}


def screen_of_the_page(name: str) -> dict[str, int]:
    """Read a screen's numbers from the page's table."""
    [row] = re.findall(rf"^\| `{name}` \|(.*)\|$", PAGE, re.M)
    return dict(zip(("columns", "rows", "centre", "horizon", "distance"), map(int, row.split("|")), strict=True))


def basis_of(camera: Camera) -> list[list[int]]:
    """Compute the camera's basis as the page says."""
    if not (camera.yaw or camera.pitch or camera.roll):
        return [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    angles = [math.radians(angle) for angle in (camera.yaw, camera.pitch, camera.roll)]
    (cy, cp, cr), (sy, sp, sr) = map(math.cos, angles), map(math.sin, angles)
    forward = cy * cp, sy * cp, sp
    right = -sy * cr - cy * sp * sr, cy * cr - sy * sp * sr, cp * sr
    up = sy * sr - cy * sp * cr, -cy * sr - sy * sp * cr, cp * cr
    return [[round(256 * part) for part in vector] for vector in (forward, right, up)]


def slope_of(screen: dict[str, int], camera: Camera, row: int, column: int) -> list[int]:
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
def test_the_table_of_screens(name):
    option, value = name.split("=")
    key = ("vga", int(value)) if option == "ROWS" else (value, 48)
    screen, page = (SCREENS | BEAM_SCREENS)[key], screen_of_the_page(name)
    found = screen.columns, screen.rows, screen.centre_column, screen.horizon_row, screen.view_distance
    assert tuple(page.values()) == found
    slopes, camera = primary_slopes(screen), Camera(position=(0, 0, 0))
    assert slopes.shape == (screen.rows, screen.columns, 3)
    for row, column in ((0, 0), (screen.horizon_row, screen.centre_column), (screen.rows - 1, screen.columns - 1)):
        assert slopes[row, column].tolist() == slope_of(page, camera, row, column)


@pytest.mark.parametrize("name", SCENES)
def test_the_page_says_what_golden_draws(name):
    """Every seventh pixel of the tiny screen is compared, with 0 to 4 reflections, from the scene's camera and a turned
    one; test_golden.py compares the arithmetic of each engine."""
    scene = load_scene(packaged_scenes()[name]).model_copy(update={"reflections": SCENES.index(name) % 5})
    table, seen = table_of(scene), (scene.reflections, scene.light)
    screen, page = SCREENS["tiny", 48], screen_of_the_page("SCREEN=tiny")
    for camera in (scene.camera, Camera(position=scene.camera.position, **TURNED)):
        shown = scene.model_copy(update={"camera": camera})
        slopes = primary_slopes(screen, camera.basis).reshape(-1, 3)
        chosen = list(range(0, len(slopes), 7))
        trace = ExactModel().trace(
            Rectangles.of_scene(shown), camera.position, shown.background, slopes[chosen], shown.reflections,
            light=shown.light,
        )  # fmt: skip
        # Reflections are the scene's unless given.
        for own, asked in ((shown.reflections, None), (4 - shown.reflections, shown.reflections)):
            picture = ExactModel().render(shown.model_copy(update={"reflections": own}), screen, asked)
            assert np.array_equal(picture.reshape(-1, 3)[chosen], trace.colours), (
                "reflections are the scene's unless given"
            )
        for ray, number in enumerate(chosen):
            slope = slope_of(page, camera, *divmod(number, screen.columns))
            compare(trace, ray, follow(table, shown.background, camera.position, slope, *seen))


def test_the_scenes_have_what_the_page_is_about():
    scenes = [load_scene(packaged_scenes()[name]) for name in SCENES]
    rectangles = [rectangle for scene in scenes for rectangle in scene.rect]
    assert {rectangle.pattern for rectangle in rectangles} == set(PATTERNS)
    assert len({rectangle.mirror for rectangle in rectangles}) >= 4
    assert any(sum(a == b for a, b in zip(*rectangle.corners, strict=True)) > 1 for rectangle in rectangles)
