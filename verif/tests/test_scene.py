# SPDX-License-Identifier: MIT
"""Scene files: accepted contents, and a one-line error for each mistake."""

from __future__ import annotations

from pathlib import Path

import pytest

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.scene import SceneError, load_scene, packaged_scenes

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
RECT = GOOD[GOOD.index("[[rect]]") :]
SINGLE = RECT.replace("[[rect]]", "[rect]")
CORNERS = "[[0, 0, 0], [511, 511, 0]]"
TOP_KEYS = "title, rows, reflections, background, camera, light, rect"
LIGHT_KEYS = "position, shade"
CAMERA_KEYS = "position, yaw, pitch, roll"
RECT_KEYS = "corners, colour, name, mirror, pattern, colour2, cell"


def write(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def changed(old: str, new: str) -> str:
    assert GOOD.count(old) == 1
    return GOOD.replace(old, new)


def complaint(path: Path, rectangles: int | None = None) -> str:
    """Return the error for a scene file without its path; the error must be one line that begins with the path."""
    with pytest.raises(SceneError) as raised:
        load_scene(path, rectangles)
    message = str(raised.value)
    assert isinstance(raised.value, UserError)
    assert message.isprintable()
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


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


FLOOR = 'rect[0] ("floor")'
POINT = "must be a point, [x, y, z], not"
TABLES = "must be one or more tables, each headed [[rect]]"
PLANE = "must have the same x, y or z in both corners, the rectangle's plane, not"
NO_VALUE = "(Expected '=' after a key in a key/value pair)"
HEADS = "(head each rectangle with [[rect]])"

MISTAKES = [
    # Unknown keys; the error reports the mistyped key rather than the missing one.
    *(
        (old, new, f"{place}: is not a key of scene files; the keys here are {keys}")
        for old, new, place, keys in (
            ("title", "titel", "titel", TOP_KEYS),
            ("title", '"ti\\ntle"', '"ti\\ntle"', TOP_KEYS),
            ("[[rect]]", "[[rects]]", "rects", TOP_KEYS),
            ("position", "angle", "camera.angle", CAMERA_KEYS),
            ("colour", "color", f"{FLOOR} color", RECT_KEYS),
            ("name", "nam", "rect[0].nam", RECT_KEYS),
            # A name with a line break still gives a one-line message.
            ('"floor"\ncorners', '"fl\\noor"\ncorner', 'rect[0] ("fl\\noor") corner', RECT_KEYS),
            (CAMERA, CAMERA + LIGHT + "dim = 1\n", "light.dim", LIGHT_KEYS),
        )
    ),
    # Numbers out of range or of another kind.
    *(
        ("256", value, f"camera.position[1]: must be a whole number 0..511, not {value}")
        for value in ("512", "-1", "2.5", "256.0", "true", '"256"')
    ),
    *(
        ("reflections = 1", f"reflections = {value}", f"reflections: must be a whole number 0..4, not {value}")
        for value in ("5", "1.0")
    ),
    *(
        ("rows = 240", f"rows = {value}", f"rows: must be 240, 200 or 180, not {value}")
        for value in ("239", "240.0", '"240"')
    ),
    ("511, 0]]", "512, 0]]", f"{FLOOR} corners[1][1]: must be a whole number 0..511, not 512"),
    (CAMERA, CAMERA + LIGHT.replace("3", "512"), "light.position[2]: must be a whole number 0..511, not 512"),
    # Wrong types and shapes.
    *(
        ("[20, 256, 100]", value, f"camera.position: {POINT} {value}")
        for value in ("20", "[20, 256]", "[1, 2, 3, 4]")
    ),
    (CAMERA, "", "camera: is missing"),
    (CAMERA, CAMERA + "[light]\n", "light.position: is missing"),
    (CAMERA, CAMERA + LIGHT + "shade = 1\n", "light.shade: must be 0, 0.25, 0.5 or 0.75, not 1"),
    (CAMERA, "light = 3\n" + CAMERA, "light: must be a table, not 3"),
    (CAMERA, "[camera]\n", "camera.position: is missing"),
    ("[camera]\nposition = [20, 256, 100]", "[[camera]]", "camera: must be a table, not [{}]"),
    (CORNERS, "[[0, 0, 0]]", f"{FLOOR} corners: must be two opposite corners, [[x, y, z], [x, y, z]], not [[0, 0, 0]]"),
    (CORNERS, "[[0, 0, 0], 3]", f"{FLOOR} corners[1]: {POINT} 3"),
    (f"corners = {CORNERS}", "", f"{FLOOR} corners: is missing"),
    (CORNERS, "[[0, 0, 0], [511, 511, 1]]", f"{FLOOR} corners: {PLANE} [[0, 0, 0], [511, 511, 1]]"),
    ("[[rect]]", "[rect]", f"rect: {TABLES}"),
    (RECT, "", "rect: is missing"),
    ('"floor"', "7", "rect[0].name: must be a string in quotes, not 7"),
    ('"A floor"', "2020-01-01", 'title: must be a string in quotes, not "2020-01-01"'),
    # Colours.
    *(
        ('"#c8c8b4"', value, f'{FLOOR} colour: must be a colour such as "#c8c8b4", not {value}')
        for value in ('"#c8c8b"', '"beige"', "[1, 2, 3]")
    ),
    ('"#000000"', "0", 'background: must be a colour such as "#c8c8b4", not 0'),
    # Angles and looks.
    *(
        ("100]", f"100]\n{name} = {value}", f"camera.{name}: must be an angle in degrees, -360..360, not {shown}")
        for name, value, shown in (
            ("yaw", "361", "361"), ("pitch", "nan", "NaN"), ("roll", "true", "true"), ("yaw", '"90"', '"90"'),
        )
    ),
    *(
        ('b4"', f'b4"\n{lines}', f"{FLOOR}{said}")
        for lines, said in (
            ("mirror = 0.3", " mirror: must be 0, 0.25, 0.5, 0.75 or 1, not 0.3"),
            ("mirror = true", " mirror: must be 0, 0.25, 0.5, 0.75 or 1, not true"),
            ('pattern = "dots"', ' pattern: must be "plain", "checker", "rows" or "columns", not "dots"'),
            (
                'pattern = "rows"\ncolour2 = "#000000"\ncell = 48',
                " cell: must be 8, 16, 32, 64, 128 or 256, not 48",
            ),
            (
                'pattern = "rows"\ncolour2 = "#000000"\ncell = 32.0',
                " cell: must be 8, 16, 32, 64, 128 or 256, not 32.0",
            ),
            ('pattern = "rows"', ": a pattern has a second colour; give colour2 with rows"),
            *(
                (line, f': {line.split()[0]} is for a pattern; give pattern = "checker", "rows" or "columns"')
                for line in ('colour2 = "#000000"', "cell = 8", "cell = 32")
            ),
        )
    ),
    # Not TOML.
    *(
        (old, new, f"is not TOML at line {where}")
        for old, new, where in (
            (RECT, 2 * SINGLE, f"11: [rect] {HEADS}"),
            (RECT, SINGLE + RECT, f"11: [[rect]] {HEADS}"),
            (RECT, RECT + SINGLE, f"11: [rect] {HEADS}"),
            ("rows = 240", " rows = ", "2: rows = (Invalid value)"),
            ("rows = 240", "rows: 2", f"2: rows: 2 {NO_VALUE}"),
            ("rows = 240", "rows = \u2028", "2 (Invalid value)"),
            ('"#c8c8b4"\n', "[1, #\n\n", "10: colour = [1, # (Invalid value)"),
            ("rows = 240", f"rows: {'2' * 54}", f"2: rows: {'2' * 54} {NO_VALUE}"),
            ("rows = 240", f"rows: {'2' * 55}", f"2 {NO_VALUE}"),
        )
    ),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "expected"), MISTAKES)
def test_mistake(tmp_path, old, new, expected):
    assert complaint(write(tmp_path, changed(old, new))) == expected


WITHOUT = GOOD.replace(RECT, "")


@pytest.mark.timeout(10)
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("rect = []\n" + WITHOUT, f"rect: {TABLES}, not []"),
        ("rect = [3]\n" + WITHOUT, "rect[0]: must be a table, not 3"),
        # A rectangle without a name is named by its index.
        (
            GOOD + "[[rect]]\ncorners = [[1, 2, 3], [4, 5, 6]]\ncolour = '#000000'\n",
            f"rect[1].corners: {PLANE} [[1, 2, 3], [4, 5, 6]]",
        ),
        # Long values are not shown; Python prints no numbers of more than a few thousand decimal digits.
        (changed("#c8c8b4", "x" * 100), f'{FLOOR} colour: must be a colour such as "#c8c8b4"'),
        (changed("rows = 240", "rows = 0x" + "f" * 4000), "rows: must be 240, 200 or 180"),
        (GOOD.replace("rows = 240", "rows" + ".a" * 2000 + " = 1"), "rows: must be 240, 200 or 180"),
        (GOOD + RECT * 40, "rect: 41 rectangles, but no hardware holds more than 32; remove some"),
        # Slow files are refused at once.
        ("a." * 50_000 + "a = 1\n" + GOOD, "has too many dots in a line; a key of a scene has one part"),
        ("#" * 1_000_000 + GOOD, "is larger than 1,000,000 bytes, the limit for scene files; remove some of it"),
    ],
    ids=["empty", "number", "unnamed", "long", "digits", "deep", "many", "dots", "bytes"],
)
def test_mistake_in_the_whole_file(tmp_path, text, expected):
    assert complaint(write(tmp_path, text), rectangles=12) == expected


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


def test_too_many_rectangles(tmp_path):
    path = write(tmp_path, GOOD + RECT * 2)
    assert len(load_scene(path, rectangles=3).rect) == 3
    assert complaint(path, rectangles=2) == (
        "rect: 3 rectangles, but the hardware holds 2; remove some or build it with --rectangles 3"
    )


@pytest.mark.parametrize(
    ("contents", "expected"),
    [
        (b"\xff\xfe", "is not UTF-8 text; a scene is a TOML file"),
        (b"\nrows = " + b"9" * 4999 + b"_0", "has a number of 5,000 digits at line 2; no number of a scene has"),
        (b"rows = " + b"[" * 5000, "is not TOML: "),
    ],
    ids=["bytes", "digits", "brackets"],
)
def test_what_is_no_scene(tmp_path, contents, expected):
    path = tmp_path / "scene.toml"
    path.write_bytes(contents)
    assert complaint(path).startswith(expected)


def test_what_is_no_file(tmp_path):
    assert complaint(tmp_path / "scene.toml") == "cannot be read: No such file or directory"
    assert complaint(tmp_path) == "cannot be read: Is a directory"
    assert "is a pipe or a device" in complaint(Path("/dev/zero"))


def test_a_byte_order_mark_is_no_part_of_the_scene(tmp_path):
    assert load_scene(write(tmp_path, "\ufeff" + GOOD)) == load_scene(write(tmp_path, GOOD))


@pytest.mark.parametrize("path", packaged_scenes().values(), ids=packaged_scenes())
def test_packaged_scenes_fit_the_default_hardware(path):
    scene = load_scene(path, configure().rectangles)
    assert scene.title
    assert all(rectangle.name for rectangle in scene.rect)
    assert path.read_text(encoding="utf-8").startswith("# SPDX-License-Identifier: MIT\n# ")
