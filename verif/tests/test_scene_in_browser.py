# SPDX-License-Identifier: MIT
"""Scene files in the browser give the same scene, or the same error, as in the shell."""

from __future__ import annotations

import itertools
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

from raycaster.configuration import LOOKS
from raycaster.scene import COMPLAINTS, Camera, Scene, SceneError, load_scene, packaged_scenes
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
0 1 2 3 -1 180 200 240 360 361 -360 511 512 8 32 256 0x10 0b11 1_0 99999999999999999999999 +7
0.0 1.0 2.0 240.0 32.0 -0.0 0.25 0.5 0.3 -12.5 360.0 360.5 1e3 1e400 -1e400 1e-5 0.0001 1.5e-7 123456789012345680.0
1e15 1e16 1e22 5e-324 0.1 nan -nan inf +inf true false
"" "plain" "rows" "dots" "240" "#123456" "#12345" "#1234567" "#12345g" "#ABCDEF\n" '\a"' "\u0001\u00e9\u007f"
[] [1] [1,2,3] [1,2,3.0] [true,2,3] [1,2,3,4] [[1,2,3]] [[1,2,3],[1,5,6]] [[1,2,3],[4,5,6]] [[1,2,3],[1,2]] [[],{}]
{} {a=1} {a.b=1,"c\td"=[true,nan]} [{}] [{position=[1,2,3]}] {position=[1,2,3]} {position=[1,2,3],tilt=1}
2020-01-01 07:32:00 07:32:00.5 2020-01-01T07:32:00 2020-01-01T07:32:00Z 2020-01-01T07:32:00-07:00
2020-01-01T07:32:00.25+05:30 2020-01-01T07:32:00-00:00
"""
"""TOML values of every kind."""

LONG_TEXTS = [f'"{character * count}"' for character in "x\u00e9\U0001f600" for count in (58, 59)]
"""The longest texts that errors show, and the shortest that they do not."""


def _parts() -> Iterator[str]:
    """Yield `FULL` with each of its numbers and points replaced by 999."""
    for part in [*re.finditer(r"\d+", FULL), *re.finditer(r"\[\d+, \d+, \d+\]", FULL)]:
        yield FULL[: part.start()] + "999" + FULL[part.end() :]


def _variants() -> Iterator[str]:
    """Yield `FULL` with each line left out, its key mistyped, or its value replaced by each of the values above."""
    lines = FULL.splitlines()
    for index, line in enumerate(lines):
        key, equals, _ = line.partition(" = ")
        others = ["", line.replace("]", ".a]", 1), line.replace("]", "s]", 1)]
        if equals:
            others = ["", f"{key}s = 1", f'"{key} \u00e9\\u007f" = 1', f"{line}\nconstructor = 1\n__proto__ = 2"]
            others += [f"{key} = {value}" for value in VALUES.split() + LONG_TEXTS]
        for other in others:
            yield "\n".join([*lines[:index], other, *lines[index + 1 :]])


def _broken(rng: random.Random) -> Iterator[str]:
    """Yield scenes with some characters or lines removed, inserted or doubled; most are no longer TOML."""
    texts = [FULL, *(re.sub("^#.*\n", "", path.read_text(), flags=re.M) for path in packaged_scenes().values())]
    while True:
        text = rng.choice(texts)
        for _ in range(rng.choice((1, 1, 2, 3))):
            at = rng.randrange(len(text) + 1)
            lines = text.split("\n")
            line = rng.randrange(len(lines))
            text = rng.choice(
                (
                    text[:at] + text[at + rng.randrange(1, 8) :],
                    text[:at] + rng.choice("[]{}\"'=.,#\n\r-_0e+ \t:x\x01é\u2028") + text[at:],
                    text[:at],
                    "\n".join(lines[:line] + lines[line + 1 :]),
                    "\n".join([*lines[:line], rng.choice(lines), *lines[line:]]),
                    "\n".join([*lines[:line], rng.choice(FULL.split("\n")), *lines[line:]]),
                )
            )
        yield text


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
        browser.add_script_tag(path=ROOT / "web" / "page" / script)
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


def _is_syntax(result: dict) -> bool:
    return result["error"] is not None and f"{NAME}: is not TOML" in result["error"]


def _agree(result: dict, expected: dict) -> bool:
    """Return True if both agree, up to a parser's reason of a syntax error; smol-toml's reasons contain no brackets."""
    if _is_syntax(result) and COMPLAINTS["heading"] not in str(expected["error"]):
        return _is_syntax(expected) and expected["error"].startswith(result["error"].rpartition(" (")[0] + " (")
    return result == expected


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
    for text, result, expected in both([*texts, *_mistakes(), *_variants(), *_parts()]):
        assert _agree(result, expected), f"{text}\n{result}\n{expected}"
        kinds[result["error"] is None] += 1
        if result["scene"]:
            needs |= {(look, result["scene"]["needs"][look]) for look in LOOKS}
    assert kinds[True] > 50
    assert kinds[False] > 1000
    assert len(needs) == 2 * len(LOOKS)


def test_other_texts(both):
    without = FULL[: FULL.index("[[rect]]")]
    texts = [
        "rect = []\n" + without,
        "rect = [3, {}, 'a']\n" + without,
        FULL.replace("\n", "\r\n"),
        FULL.replace("\n", "\r"),
        "\ufeff" + FULL,
        "",
        " \n",
        "rows" + ".a" * 2000 + " = 1",
        "rows = 0x" + "f" * 4000,
        FULL.replace('"floor"', "'fl\u00f6\u2028\U0001f600\"'").replace("colour =", "color ="),
        # More rectangles than this design holds, and than any does.
        *(FULL + FULL[FULL.rindex("[[rect]]") :] * count for count in (11, 40)),
    ]
    for text, result, expected in both(texts, 12):
        assert result == expected, text
    for _, result, expected in both(["rows = " + "9" * 5000, "rows = " + "[" * 5000]):
        assert result["error"] and expected["error"]


def test_bytes(page):
    script = """([bytes, schema]) => RayCasterScene.read(new Uint8Array(bytes).buffer, "dropped.toml", schema)"""
    result = page.evaluate(script, [list(b"\xef\xbb\xbf" + FULL.encode()), scene_schema()])
    assert result["scene"]["title"] == "All keys"
    result = page.evaluate(script, [[0xFF, 0xFE], scene_schema()])
    assert result == {"scene": None, "error": "dropped.toml: is not UTF-8 text; a scene is a TOML file"}


def test_broken_texts(both):
    """Browser and shell accept the same texts and report errors at the same line, except those named in scene.js."""
    kinds = Counter()
    for text, result, expected in both(list(itertools.islice(_broken(random.Random(seed())), 1000))):
        note = f"{text}\n{result['error']}\n{expected['error']}"
        assert _is_syntax(result) == _is_syntax(expected), note
        if _agree(result, expected):
            kinds["same line" if _is_syntax(result) else "same"] += 1
        else:
            assert _is_syntax(result), note
            kinds["other line"] += 1
            assert re.search(r" \((unfinished|control characters|trying to redefine) .*\)$", result["error"]), note
            lines = [int(re.search(r"is not TOML at line (\d+)", one["error"])[1]) for one in (result, expected)]
            assert lines[0] < lines[1], note
    assert kinds["same"] > 200, kinds
    assert kinds["same line"] > 400, kinds
    assert kinds["other line"] < 20, kinds


def _bases(page, angles: list[list[float]]) -> list[list[list[int]]]:
    return page.evaluate("(all) => all.map((angles) => RayCasterScene.basis(...angles))", angles)


def _expected_basis(yaw: float, pitch: float, roll: float) -> list[list[int]]:
    return [list(vector) for vector in Camera(position=(0, 0, 0), yaw=yaw, pitch=pitch, roll=roll).basis]


def test_basis(page):
    rng = random.Random(seed())
    steps = [15.0 * step for step in range(-24, 25)]
    angles = [[rng.choice(steps) for _ in range(3)] for _ in range(2000)]
    angles += [[rng.uniform(-360, 360) for _ in range(3)] for _ in range(2000)]
    for three, basis in zip(angles, _bases(page, angles), strict=True):
        assert basis == _expected_basis(*three), three


def test_halves_of_a_basis_are_rounded_to_even(page):
    """Only angles whose cosine is such a half in both are tested, since libraries may differ in its last bit."""
    near = [math.degrees(math.acos((part + 0.5) / 256)) for part in range(-256, 256)]
    angles = [angle + step * math.ulp(angle) for angle in near for step in range(-50, 50)]
    cosines = page.evaluate("(angles) => angles.map((angle) => Math.cos(angle * (Math.PI / 180)))", angles)
    halves = [
        angle
        for angle, cosine in zip(angles, cosines, strict=True)
        if cosine * 256 % 1 == 0.5 and math.cos(math.radians(angle)) == cosine
    ]
    assert len(halves) > 50
    for angle, basis in zip(halves, _bases(page, [[angle, 0, 0] for angle in halves]), strict=True):
        assert basis[0][0] == _expected_basis(angle, 0, 0)[0][0], angle
