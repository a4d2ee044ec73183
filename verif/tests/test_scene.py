# SPDX-License-Identifier: MIT
"""Scene files: accepted contents; `mistakes/scenes.txt` has the others."""

from __future__ import annotations

from pathlib import Path

import pytest

from raycaster.configuration import MOST_RECTANGLES
from raycaster.design.decide import configure
from raycaster.scene import load_scene, packaged_scenes

GOOD = """\
title = "A floor"
rows = 240
reflections = 1
background = "#000000"
[camera]
position = [20, 256, 100]
[[rect]]
name = "floor"
corners = [[0, 0, 0], [511, 511, 0]]
colour = "#c8c8b4"
"""
CAMERA = "[camera]\nposition = [20, 256, 100]\n"
LIGHT = "[light]\nposition = [1, 2, 3]\n"


def write(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def changed(old: str, new: str) -> str:
    assert GOOD.count(old) == 1
    return GOOD.replace(old, new)


@pytest.mark.parametrize("rows", [240, 200, 180])
def test_reads_a_scene(tmp_path, rows):
    scene = load_scene(write(tmp_path, changed("rows = 240", f"rows = {rows}")), rectangles=1)
    assert (scene.title, scene.rows, scene.reflections, scene.background) == ("A floor", rows, 1, (0, 0, 0))
    assert scene.camera.position == (20, 256, 100)
    (floor,) = scene.rect
    assert (floor.name, floor.corners, floor.colour) == ("floor", ((0, 0, 0), (511, 511, 0)), (0xC8, 0xC8, 0xB4))
    assert floor.axis == 2


def test_fills_in_the_defaults(tmp_path):
    scene = load_scene(write(tmp_path, CAMERA + "[[rect]]\ncorners = [[0, 0, 0], [0, 0, 0]]\ncolour = '#ABCDEF'\n"))
    assert (scene.title, scene.rows, scene.reflections, scene.background) == ("", 240, 1, (0, 0, 0))
    assert (scene.rect[0].name, scene.rect[0].axis) == ("", 0)


LOOKS = """\
yaw = 30
pitch = -12.5
[[rect]]
corners = [[0, 0, 0], [511, 511, 0]]
colour = "#c8c8b4"
mirror = 0.25
pattern = "columns"
colour2 = "#010203"
cell = 128
[[rect]]
corners = [[0, 0, 0], [511, 511, 0]]
colour = "#c8c8b4"
mirror = 1
"""


def test_reads_angles_and_looks(tmp_path):
    scene = load_scene(write(tmp_path, CAMERA + LOOKS))
    assert (scene.camera.yaw, scene.camera.pitch, scene.camera.roll) == (30, -12.5, 0)
    first, second = scene.rect
    assert (first.quarters, first.kind, first.cell_code, first.colour2) == (1, 3, 4, (1, 2, 3))
    assert (second.quarters, second.kind, second.cell, second.colour2) == (4, 0, 32, None)
    assert scene.needs == {"turn": True, "materials": True, "patterns": True, "light": False}
    assert scene.lacks(("turn", "patterns")) == ["materials"]
    plain = load_scene(write(tmp_path, changed("100]", "100]\nyaw = 360\nroll = -360")))
    assert (plain.needs, plain.rect[0].quarters) == (dict.fromkeys(plain.needs, False), 2)
    lit = load_scene(write(tmp_path, changed(CAMERA, CAMERA + LIGHT)))
    assert (lit.needs["light"], lit.light.position, lit.light.quarters) == (True, (1, 2, 3), 2)


def test_a_byte_order_mark_is_no_part_of_the_scene(tmp_path):
    assert load_scene(write(tmp_path, "\ufeff" + GOOD)) == load_scene(write(tmp_path, GOOD))


@pytest.mark.parametrize("path", packaged_scenes().values(), ids=packaged_scenes())
def test_packaged_scenes_fit_the_default_hardware(path):
    """All but levels do."""
    scene = load_scene(path, MOST_RECTANGLES if path.with_suffix(".txt").exists() else configure().rectangles)
    assert scene.title
    assert all(rectangle.name for rectangle in scene.rect)
    assert path.read_text(encoding="utf-8").startswith("# SPDX-License-Identifier: MIT\n# ")
