# SPDX-License-Identifier: MIT
"""Maps of characters: what is seen at each place of the scene; `mistakes/levels.txt` has maps that are refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, refusal

from raycaster import level
from raycaster.cli.import_level import main
from raycaster.level import load_level
from raycaster.scene import Scene, load_scene, packaged_scenes

PAGE = ROOT / "docs" / "scenes.md"

HEAD = """\
// Walls of three looks, floors of two, one of them below the sky.
cell {cell}
height 50
side 0.5
# wall #206040
R wall #a04020 rows #000000 8
M mirror #c8d4dc 0.75
. floor #806040 ceiling #e0d0c0
c floor #402010 checker #604020 ceiling none
^ start 30
"""
WALLS = {"#": (0x20, 0x60, 0x40), "R": (0xA0, 0x40, 0x20), "M": (0xC8, 0xD4, 0xDC)}
FLOORS = {".": (0x80, 0x60, 0x40), "c": (0x40, 0x20, 0x10), "^": (0x80, 0x60, 0x40)}
CEILINGS = {".": (0xE0, 0xD0, 0xC0), "c": None, "^": (0xE0, 0xD0, 0xC0)}


def random_map(rng: np.random.Generator) -> list[str]:
    """Draw the lines of a map, some of them shorter than others; the first line is the furthest along x."""
    rows, columns = rng.integers(3, 12, 2)
    share = rng.random() * 0.6
    cells = np.where(rng.random((rows, columns)) < share, rng.choice([*"#RM"], (rows, columns)), ".")
    cells[(rng.random((rows, columns)) < 0.3) & (cells == ".")] = "c"
    cells[rng.integers(rows), 0] = "^"
    return ["".join(line[: columns - int(rng.integers(3)) if rng.random() < 0.2 else columns]) for line in cells]


def seen(scene: Scene, low: tuple[int, ...], high: tuple[int, ...]) -> tuple[int, int, int] | None:
    """Return the colour of the first rectangle that covers a place of a plane, None if there is none."""
    for rect in scene.rect:
        ends = list(zip(*rect.corners, strict=True))
        if all(min(end) <= a and b <= max(end) for end, a, b in zip(ends, low, high, strict=True)):
            return rect.colour
    return None


def test_each_place_is_seen_as_on_the_map(tmp_path, random):
    """Each floor, ceiling and wall has its look, and there is nothing between open cells, whatever was merged."""
    merged = pieces = 0
    for _ in range(30):
        lines, cell = random_map(random), int(random.choice([8, 16, 40]))
        path = tmp_path / "level.txt"
        path.write_text(HEAD.format(cell=cell) + "\n" + "\n".join(lines) + "\n")
        scene = load_level(path)
        rows = lines[::-1]
        at = {(x, y): kind for x, line in enumerate(rows) for y, kind in enumerate(line)}
        for (x, y), kind in at.items():
            near, far = (cell * x, cell * y), (cell * x + cell, cell * y + cell)
            if kind in FLOORS:
                assert seen(scene, (*near, 0), (*far, 0)) == FLOORS[kind]
                assert seen(scene, (*near, 50), (*far, 50)) == CEILINGS[kind]
                pieces += 2
            for axis in range(2):
                other = at.get((x + 1, y) if axis == 0 else (x, y + 1))
                low = [cell * x, cell * y]
                low[axis] += cell
                found = seen(scene, (*low, 0), (low[0] + cell * axis, low[1] + cell * (1 - axis), 50))
                walls = [WALLS[one] for one in (kind, other) if one in WALLS]
                if not walls:
                    assert found is None
                elif len(walls) == 1 and other:
                    assert other in FLOORS or kind in FLOORS
                    colour = walls[0]
                    shaded = axis == 1 and colour != WALLS["M"]
                    assert found == (tuple(round(part / 2) for part in colour) if shaded else colour)
                    pieces += 1
        merged += len(scene.rect)
    assert merged < pieces / 2


def test_a_room_has_six_rectangles(tmp_path):
    """The start is in the middle of its cell and looks as its arrow; the light is below the ceiling."""
    path = tmp_path / "small_room.txt"
    path.write_text("####\n#.*#\n#>.#\n####\n")
    scene = load_level(path)
    assert scene.title == "Small room"
    assert [rect.name for rect in scene.rect] == ["floor 1", "ceiling 1", "wall 1", "wall 2", "wall 3", "wall 4"]
    assert {rect.corners[0][0] for rect in scene.rect if rect.axis == 0} == {32, 96}
    assert (scene.camera.position, scene.camera.yaw) == ((48, 48, 40), 90)
    assert scene.light and (scene.light.position, scene.light.shade) == ((80, 80, 84), 0.5)


@pytest.mark.parametrize(("arrow", "yaw"), [("^", 0), (">", 90), ("v", 180), ("<", -90)])
def test_an_arrow_gives_the_view(arrow, yaw, tmp_path):
    path = tmp_path / "level.txt"
    path.write_text(f"###\n#{arrow}#\n###\n")
    assert load_level(path).camera.yaw == yaw


def test_looks_that_are_not_said(tmp_path):
    """A start, a light, a space and a floor without a colour look like the usual floor; colours are dimmed alike."""
    head = "side 0.5\n# wall #406080 checker #204060 16\n. floor #102030 ceiling none\n"
    path = tmp_path / "level.txt"
    path.write_text(f"{head}c floor\n\n#######\n#.^c* #\n#######\n")
    scene = load_level(path)
    assert [(rect.name, rect.colour) for rect in scene.rect if rect.axis == 2] == [("floor 1", (16, 32, 48))]
    walls = [rect for rect in scene.rect if rect.axis != 2]
    assert {(rect.pattern, rect.cell) for rect in walls} == {("checker", 16)}
    for axis, looks in ((0, ((64, 96, 128), (32, 64, 96))), (1, ((32, 48, 64), (16, 32, 48)))):
        assert {(rect.colour, rect.colour2) for rect in walls if rect.axis == axis} == {looks}
    path.write_text(f"{head}  floor #ffffff\n\n#######\n#.^.. #\n#######\n")
    assert {rect.colour for rect in load_level(path).rect if rect.axis == 2} == {(16, 32, 48), (255, 255, 255)}


def test_a_map_at_its_limits(tmp_path, monkeypatch):
    """As many rectangles as the hardware holds, and as many bytes as are read, are not too many."""
    path = tmp_path / "level.txt"
    path.write_text("####\n#.*#\n#>.#\n####\n")
    for name, size in (("MOST_RECTANGLES", 6), ("MOST_BYTES", path.stat().st_size)):
        with monkeypatch.context() as patch:
            patch.setattr(level, name, size)
            load_level(path)
            patch.setattr(level, name, size - 1)
            with pytest.raises(level.LevelError):
                load_level(path)


def test_the_last_cell_ends_with_the_world(tmp_path):
    path = tmp_path / "level.txt"
    path.write_text("cell 128\n\n....\n.##.\n.##.\n^...\n")
    assert max(rect.corners[1][1] for rect in load_level(path).rect) == 511


@pytest.mark.parametrize("path", [path for path in packaged_scenes().values() if path.with_suffix(".txt").exists()])
def test_packaged_levels_are_made_of_their_maps(path):
    assert load_scene(path) == load_level(path.with_suffix(".txt"))


def test_the_command(tmp_path, capsys, monkeypatch):
    """It writes a scene, of the map on the page too, replaces what it wrote, and nothing else."""
    monkeypatch.chdir(tmp_path)
    [text] = re.findall(r"^```text\n(.*?)^```", PAGE.read_text(), re.M | re.S)
    Path("level.txt").write_text(text)
    for _ in range(2):
        main(["level.txt"])
        assert load_scene("level.toml") == load_level("level.txt")
    said = capsys.readouterr().out.splitlines()
    count = len(load_scene("level.toml").rect)
    assert said == 2 * [f"level.toml: {count} rectangles; to walk through it: raycaster play level.toml"]
    main(["level.txt", "-o", "other.toml"])
    assert load_scene("other.toml") == load_scene("level.toml")
    Path("other.toml").write_text("title = 'mine'\n")
    assert "other.toml: is there already" in refusal(tmp_path, "import", "level.txt", "-o", "other.toml")
    assert Path("other.toml").read_text() == "title = 'mine'\n"
