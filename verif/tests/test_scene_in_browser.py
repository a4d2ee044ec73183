# SPDX-License-Identifier: MIT
"""Scene files in the browser give the same scene, or an error at the same place, as in the shell."""

from __future__ import annotations

import json
import math
import random
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from test_mistakes import MISTAKES, cases

from raycaster.configuration import FEATURES
from raycaster.scene import Camera, Scene, SceneError, load_scene, packaged_scenes
from raycaster.verif.seeds import seed
from raycaster.web.site import scene_schema

NAME = "scene.toml"

FULL = """\
title = "All keys"
rows = 200
reflections = 2
background = "#0A0b0c"
[camera]
position = [20, 256, 100]
yaw = 30
pitch = -12.5
roll = 0.0
[light]
position = [1, 2, 300]
shade = 0.75
[[rect]]
corners = [[0, 0, 0], [511, 511, 0]]
colour = "#c8c8b4"
name = "floor"
mirror = 0.25
pattern = "columns"
colour2 = "#010203"
cell = 128
[[rect]]
corners = [[1, 2, 3], [1, 2, 3]]
colour = "#ffffff"
"""

VALUES = r"""
0 1 2 3 -1 200 240 360 361 -360 511 512 8 256 0x10 1_0 99999999999999999999999
1.0 240.0 32.0 -0.0 0.25 0.5 0.3 -12.5 360.5 1e400 nan -inf true false "" "plain" "rows" "dots" "#123456" "#12345g"
[] [1] [1,2,3] [1,2,3.0] [true,2,3] [[1,2,3]] [[1,2,3],[1,5,6]] [[1,2,3],[4,5,6]] [[1,2,3],[1,2]] [[],{}]
{} {a=1} [{}] [{position=[1,2,3]}] {position=[1,2,3]} {position=[1,2,3],tilt=1} 2020-01-01
"""
"""TOML values of every kind."""


def _variants() -> Iterator[str]:
    """Yield `FULL` with each line left out, its key mistyped, or its value replaced by each of the values above."""
    lines = FULL.splitlines()
    for index, line in enumerate(lines):
        key, equals, _ = line.partition(" = ")
        others = ["", line.replace("]", ".a]", 1), line.replace("]", "s]", 1)]
        if equals:
            others = ["", f"{key}s = 1", f'"{key} \\t" = 1', f"{line}\nconstructor = 1\n__proto__ = 2"]
            others += [f"{key} = {value}" for value in VALUES.split()]
        for other in others:
            yield "\n".join([*lines[:index], other, *lines[index + 1 :]])


def _as_read(scene: Scene) -> dict[str, object]:
    """Return a scene in the form that `RayCasterScene.read` must return."""
    read = json.loads(scene.model_dump_json(exclude={"rect", "background", "light"}))
    rects = [
        {
            "name": rectangle.name, "corners": rectangle.corners, "colour": rectangle.colour,
            "quarters": rectangle.quarters, "kind": rectangle.kind, "cell": rectangle.cell,
            "colour2": rectangle.colour2 or (0, 0, 0),
        }
        for rectangle in scene.rect
    ]  # fmt: skip
    light = scene.light and {"position": scene.light.position, "quarters": scene.light.quarters}
    more = {"background": scene.background, "light": light, "rect": rects, "needs": scene.needs}
    return read | json.loads(json.dumps(more))


@pytest.fixture(scope="module")
def page(browser):
    for script in ("vendor/smol-toml.js", "scene.js"):
        browser.add_script_tag(path=ROOT / "raycaster" / "web" / "page" / script)
    return browser


@pytest.fixture
def both(page, tmp_path, monkeypatch):
    """Return a function that reads texts in the browser and in the shell, and yields each text with both results."""
    monkeypatch.chdir(tmp_path)

    def in_shell(text: str, rectangles: int | None) -> dict:
        Path(NAME).write_bytes(text.encode())
        try:
            return {"scene": _as_read(load_scene(Path(NAME), rectangles)), "error": None}
        except SceneError as error:
            return {"scene": None, "error": str(error)}

    def read(texts: list[str], rectangles: int | None = None) -> Iterator[tuple[str, dict, dict]]:
        script = "([texts, ...rest]) => texts.map((text) => RayCasterScene.read(text, ...rest))"
        results = page.evaluate(script, [texts, NAME, scene_schema(), rectangles or math.inf])
        for text, result in zip(texts, results, strict=True):
            yield text, result, in_shell(text, rectangles)

    return read


def _short(result: dict) -> dict:
    """Leave out of an error what parsers and languages word differently: the given value, and the fault of syntax."""
    error = result["error"] and result["error"].partition(", not ")[0]
    return result | {"error": error and re.sub(r"(is not TOML|has a number of).*", "is not TOML", error, flags=re.S)}


def _mistakes() -> Iterator[str]:
    """Yield the texts, not too long, for which the shell's tests expect errors."""
    good = (MISTAKES / "files" / NAME).read_text()
    for edits, each, _ in cases(MISTAKES / "scenes.txt"):
        if edits.startswith(NAME) and "((" not in edits and r"\udc" not in edits:
            text = good
            for _, right, wrong in each:
                text = text.replace(right, wrong)
            yield text


def test_packaged_scenes_and_every_value_at_every_key(both):
    texts = [path.read_text(encoding="utf-8") for path in packaged_scenes().values()]
    kinds, needs = Counter(), set()
    for text, result, expected in both([*texts, *_mistakes(), *_variants()]):
        assert _short(result) == _short(expected), f"{text}\n{result}\n{expected}"
        kinds[result["error"] is None] += 1
        if result["scene"]:
            needs |= {(look, result["scene"]["needs"][look]) for look in FEATURES}
    assert kinds[True] > 50
    assert kinds[False] > 500
    assert len(needs) == 2 * len(FEATURES)


def test_other_texts(both):
    texts = [
        FULL.replace("\n", "\r\n"),
        "\ufeff" + FULL,
        "",
        "rows = " + "[" * 5000,
        # More rectangles than this design holds, and than any does.
        *(FULL + FULL[FULL.rindex("[[rect]]") :] * count for count in (11, 40)),
    ]
    for text, result, expected in both(texts, 12):
        assert _short(result) == _short(expected), f"{text}\n{result}\n{expected}"


def test_the_place_of_a_fault_of_syntax_is_shown(both):
    [(_, result, _)] = both([FULL.replace("rows = 200", "rows: 200")])
    assert re.fullmatch(rf"{NAME}: is not TOML at line 2: rows: 200 \(.+\)", result["error"])


def test_bytes(page):
    script = """([bytes, schema]) => RayCasterScene.read(new Uint8Array(bytes).buffer, "dropped.toml", schema)"""
    result = page.evaluate(script, [list(b"\xef\xbb\xbf" + FULL.encode()), scene_schema()])
    assert result["scene"]["title"] == "All keys"
    result = page.evaluate(script, [[0xFF, 0xFE], scene_schema()])
    assert result == {"scene": None, "error": "dropped.toml: is not UTF-8 text; a scene is a TOML file"}


def test_basis(page):
    rng, steps = random.Random(seed()), [15.0 * step for step in range(-24, 25)]
    angles = [[rng.choice(steps) for _ in range(3)] for _ in range(2000)]
    angles += [[rng.uniform(-360, 360) for _ in range(3)] for _ in range(2000)]
    bases = page.evaluate("(all) => all.map((angles) => RayCasterScene.basis(...angles))", angles)
    for (yaw, pitch, roll), basis in zip(angles, bases, strict=True):
        expected = Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis
        assert basis == [list(vector) for vector in expected], (yaw, pitch, roll)
