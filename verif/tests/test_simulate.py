# SPDX-License-Identifier: MIT
"""`make sim` from outside: its outputs, its exit codes, and one line for each mistake."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, SMALL_SCENE
from PIL import Image

from raycaster.design import design_for

RESULT_KEYS = {
    "pixels",
    "wrong_vs_golden",
    "wrong_vs_exact",
    "worst_row_cycles",
    "frame_cycles",
    "worst_group_cycles",
    "underrun",
    "sim_seconds",
}

# Icarus builds at once.
SMALL_OPTIONS = (SMALL_SCENE, "--screen", "tiny", "--units", 8, "--rectangles", 3, "--simulator", "icarus")


def _sim(*arguments: object, build: Path, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "raycaster.cli", "sim", "--build", str(build), *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


@pytest.fixture
def build(tmp_path: Path) -> Path:
    """A build directory of its own."""
    return tmp_path / "build"


def test_one_scene(build, scenes):
    """Pictures, results, table and exit code; with Icarus, which builds at once."""
    first = _sim(*SMALL_OPTIONS, build=build)
    assert first.returncode == 0, first.stdout + first.stderr
    assert "12288" in first.stdout
    output = build / "sim" / "small"
    for name in ("frame", "golden", "exact", "diff"):
        assert Image.open(output / f"{name}.png").size == (128, 96)
    assert (output / "frame.png").read_bytes() == (output / "golden.png").read_bytes()
    result = json.loads((output / "result.json").read_text())
    assert result.keys() >= RESULT_KEYS
    assert result["wrong_vs_golden"] == 0
    assert [path.name for path in output.parent.iterdir()] == ["small"], "nothing half-written is left"
    assert "was built before" not in first.stdout
    assert "was built before" in _sim(*SMALL_OPTIONS, build=build).stdout


def test_two_scenes(build, tmp_path):
    """One picture has both."""
    other = tmp_path / "other.toml"
    other.write_text(SMALL_SCENE.read_text().replace("#c8c8b4", "#ff0000"))
    ran = _sim(*SMALL_OPTIONS, other, build=build)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    sheet = Image.open(build / "sim" / "scenes.png")
    assert sheet.size == (2 * 320 + 8, 240)
    floors = [sheet.getpixel((left + 160, 235)) for left in (0, 328)]
    assert floors == [Image.open(build / "sim" / name / "frame.png").getpixel((64, 94)) for name in ("small", "other")]
    assert str(build / "sim" / "scenes.png") in ran.stdout


def test_waves(build, scenes):
    """Waveforms are written where the last lines say."""
    ran = _sim(*SMALL_OPTIONS, "--waves", build=build)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    waves = build / "sim" / "small" / "waves.fst"
    assert waves.stat().st_size > 0
    assert str(waves) in ran.stdout


def test_a_wrong_pixel_fails(build, scenes):
    """Exit code 1 and a line that says where to look, when the hardware is not what golden is."""
    assert _sim(*SMALL_OPTIONS, build=build).returncode == 0
    (verilog,) = (build / "model").glob("*/verilog")
    (combiner,) = verilog.glob("colour_combiner*.v")
    broken = re.sub(r"assign pixel_word = (.+);", r"assign pixel_word = ~\1;", combiner.read_text())
    assert broken != combiner.read_text()
    combiner.write_text(broken)
    ran = _sim(*SMALL_OPTIONS, build=build)
    assert ran.returncode == 1
    assert "pixels are wrong" in ran.stdout
    assert str(build / "sim" / "small" / "sim.log") in ran.stdout
    assert str(build / "sim" / "small" / "diff.png") in ran.stdout
    command = f"raycaster trace {SMALL_SCENE} --pixel 0,0 --units 8 --rectangles 3 --screen tiny --simulator icarus"
    assert command in ran.stdout


SCENE = """
[camera]
position = [20, 256, 100]
[[rect]]
corners = [[0, 0, 0], [511, 511, 0]]
colour = "#c8c8b4"
"""


TURNED = SCENE.replace("100]", "100]\nyaw = 20")
PATTERNED = SCENE + 'pattern = "rows"\ncolour2 = "#000000"'


@pytest.mark.parametrize(
    ("text", "options", "complaint"),
    [
        (None, (), "cannot be read"),
        ("[camera", (), "is not TOML"),
        ("rows = 180" + SCENE, (), "180 rows need the beam engine"),
        (SCENE.replace("511, 0]", "511, 1]"), (), "rect"),
        (SCENE.replace("256", "512"), (), "camera"),
        (SCENE + SCENE[SCENE.index("[[rect") :] * 12, (), "13 rectangles, but the hardware holds 12"),
        (SCENE, ("--units", "7"), "units: 7 does not divide"),
        (SCENE, ("--units", "many"), "units: "),
        (SCENE, ("--units", "4"), "row budget: "),
        (SCENE, ("--rows", "180"), "rows: "),
        (SCENE, ("--rounding", "up"), "rounding: "),
        (SCENE, ("--screen", "tiny", "--rows", "240"), "rows: "),
        (SCENE, ("--divider-bits", "4"), "divider_bits: "),
        (SCENE, ("--fraction-bits", "9"), "fraction_bits: "),
        (SCENE, ("--colour-bits", "0"), "colour_bits: "),
        (SCENE, ("--reflections", "5"), "reflections: "),
        (TURNED, ("--engine", "seed"), "the seed engine measures depth along x, so its camera cannot turn"),
        (TURNED, ("TURN=0",), "the scene needs a camera that turns; leave TURN out"),
        (SCENE + "mirror = 0", ("MATERIALS=0",), "the scene needs rectangles that mirror more or less than half"),
        (PATTERNED, ("PATTERNS=0",), "the scene needs rectangles with patterns; leave PATTERNS out"),
        (TURNED, ("FIX=all", "ENGINE=seed"), "the seed engine measures depth along x"),
        (SCENE, ("--simulator", "questa"), "simulator: verilator or icarus, not questa"),
    ],
)
def test_mistakes(build, tmp_path, text, options, complaint):
    """Exit code 2, one line, no traceback, nothing written."""
    scene = tmp_path / "mine.toml"
    if text is not None:
        scene.write_text(text)
    ran = _sim(scene, *options, build=build)
    assert ran.returncode == 2
    assert complaint in ran.stderr
    assert ran.stderr.startswith("error: ")
    assert ran.stderr.count("\n") == 1
    assert ran.stdout == ""
    assert not build.exists()


def test_a_scene_chooses_what_it_needs(tmp_path):
    def chosen(text, **options):
        path = tmp_path / "mine.toml"
        path.write_text(text)
        config = design_for(path, options).configuration
        return config.engine, config.looks

    assert chosen(SCENE) == ("seed", ())
    assert chosen(SCENE, engine="exact", turn="1") == ("exact", ("turn",))
    assert chosen(TURNED) == ("exact", ("turn",))
    assert chosen(TURNED, engine="beam") == ("beam", ("turn",))
    assert chosen(PATTERNED) == ("seed", ("patterns",))
    assert chosen(TURNED + "mirror = 0") == ("exact", ("turn", "materials"))


def test_two_scenes_of_one_name(build, scenes, tmp_path):
    """They would overwrite each other."""
    shutil.copy(scenes / "floor.toml", tmp_path)
    ran = _sim(scenes / "floor.toml", tmp_path / "floor.toml", build=build)
    assert ran.returncode == 2
    assert "same file name" in ran.stderr


def test_a_packaged_scene_from_anywhere(tmp_path):
    """By its name, from a directory without scenes, into the directory's own build/."""
    command = [sys.executable, "-m", "raycaster.cli", "sim", "matte", "SCREEN=tiny", "ENGINE=exact"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert (tmp_path / "build" / "sim" / "matte" / "frame.png").is_file()


def test_no_such_scene(tmp_path):
    ran = _sim("mirror_rooms", build=tmp_path, cwd=tmp_path)
    assert ran.returncode == 2
    assert re.fullmatch(r"error: mirror_rooms: no such file, and none of the packaged scenes: boxes, .*\n", ran.stderr)


@pytest.mark.parametrize(
    ("simulator", "present", "complaint"),
    [
        ("icarus", (), "Icarus Verilog is missing; install it"),
        ("verilator", ("make", "perl"), "g++ is missing"),
        ("verilator", ("g++", "perl"), "make is missing"),
        ("verilator", ("g++", "make"), "perl is missing"),
    ],
)
def test_missing_tools(build, scenes, tmp_path, monkeypatch, simulator, present, complaint):
    """One line says what to install."""
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in present:
        (tools / tool).symlink_to(shutil.which(tool))
    monkeypatch.setenv("PATH", str(tools))
    ran = _sim(scenes / "floor.toml", "--simulator", simulator, build=build)
    assert ran.returncode == 2
    assert complaint in ran.stderr
    assert ran.stderr.count("\n") == 1
