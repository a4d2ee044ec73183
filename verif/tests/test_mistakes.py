# SPDX-License-Identifier: MIT
"""Mistakes on the command line: each gets one line without a traceback, and no file is written, changed or removed."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from conftest import FLOOR_SCENE, PATTERNED_SCENE, TURNED_SCENE, refusal

from raycaster.sim.simulator import MODELS_VARIABLE

OF_SCENES = [
    ("[camera", "", "is not TOML"),
    (
        "rows = 180" + FLOOR_SCENE,
        "",
        "mine.toml: rows: seed has 240, 200, 120, 96, 60 rows on screen vga, not 180; choose --engine ",
    ),
    (FLOOR_SCENE + FLOOR_SCENE[FLOOR_SCENE.index("[[rect") :] * 12, "", "13 rectangles, but the hardware holds 12"),
    (TURNED_SCENE, "--engine seed", "the seed engine measures depth along x, so its camera cannot turn"),
    (TURNED_SCENE, "FIX=all ENGINE=seed", "the seed engine measures depth along x"),
    (TURNED_SCENE, "TURN=0", "the scene needs a camera that turns; leave out --turn"),
    (FLOOR_SCENE + "mirror = 0", "MATERIALS=0", "the scene needs rectangles that mirror more or less than half"),
    (PATTERNED_SCENE, "PATTERNS=0", "the scene needs rectangles with patterns; leave out --patterns"),
]
"""Text of a scene, options of `sim` and the complaint."""

OF_COMMANDS = {
    "": [
        ("smi", "unknown command: smi (did you mean sim?); raycaster --help lists all"),
        ("soak", "unknown command: soak (did you mean verify soak?); raycaster --help lists all"),
        ("verify sok", "unknown command: verify sok (did you mean verify soak?); raycaster --help lists all"),
        ("xyzzy", "unknown command: xyzzy; raycaster --help lists all"),
    ],
    "sim": [
        ("--enigne beam", "unknown option: --enigne (did you mean --engine?); see raycaster sim --help"),
        ("--xyzzy", "unknown option: --xyzzy; see raycaster sim --help"),
        ("ENGIN=beam", "ENGIN: raycaster sim does not take it (did you mean ENGINE?); see raycaster sim --help"),
        ("SIMM=icarus", "SIMM: raycaster sim does not take it (did you mean SIM?); see raycaster sim --help"),
        ("mirror_rom", "mirror_rom: no such file or packaged scene (did you mean mirror_room?)"),
        ("boxs.toml", "boxs.toml: cannot be read: No such file or directory (did you mean boxes?)"),
        ("--engine baem", "engine: expected seed, exact or beam, got baem (did you mean beam?)"),
        ("--rectangles 99", "rectangles: expected 32 or less, got 99"),
        ("--rectangles 12.0", "rectangles: expected a whole number, got 12.0"),
        ("--rectangles " + "1" * 5000, "rectangles: expected a number of fewer digits, got '111111"),
        ("--jobs " + "1" * 5000, "argument --jobs: invalid int value: a number of 5,000 digits"),
        ("b\udcff.toml", "b\\xff.toml: has a name that is not UTF-8"),
        ("boxes de2/boxes.toml", "same file name"),
        ("mine.toml --units 7", "units: 7 does not divide"),
        ("mine.toml --simulator questa", "simulator: expected verilator or icarus, got questa"),
        ("--gates mine.toml --cells xilinx", "cells: expected ecp5 or ice40 or gowin, got xilinx"),
    ],
    "trace": [
        ("", "pixel: expected a ray's column and row, as in --pixel 160,120, got none"),
        ("--pixel 48", "pixel: expected a ray's column and row, as in 160,120, got 48"),
        ("--pixel 3,-4", "a ray's column and row"),
        ("--pixel 64,9 --screen tiny", "pixel: expected column from 0 to 63 and row from 0 to 47, got 64,9"),
        ("--pixel 1,1 no.toml", "no.toml"),
    ],
    "wave --screen tiny": [
        ("--pixel 3,3 --span 4,5", "span: rows 4 to 5 do not include the pixel's row 3"),
        ("--pixel 3,3 --span 0,48", "span: expected rows from 0 to 47 in rising order, got 0,48"),
        ("--pixel 3,3 --span few", "span: expected the first and the last row"),
    ],
    "verilog": [
        ("boxes FIX=some", "fix: expected rects or all, got some"),
        ("boxes FIX=all RECTANGLES=12", "leave out --rectangles"),
        ("FIX=all", "needs a scene"),
        ("boxes", "give --fix rects or --fix all"),
        ("nowhere.toml FIX=all", "nowhere.toml"),
        ("--output file", "file"),
        ("--output /proc/x", "/proc/x"),
        ("--output " + "x" * 300, "File name too long"),
        ("--output mine", "has files in it"),
        ("--bus pci", "bus: expected avalon, axi4lite, wishbone or apb, got pci"),
        ("PREFIX=9x", "prefix: expected the beginning of a Verilog name, such as ray_caster_, got 9x"),
    ],
    "registers": [
        ("--output mine", "has files in it"),
        ("--rectangles x", "rectangles: expected a whole number, got x"),
    ],
    "game": [("--frames 0", "frames: expected at least 1, got 0")],
    "web": [("--keep web.json", "keep: there is nothing to keep without --measure")],
    "commands": [("--output file", "file")],
    "quartus": [
        ("", "board: expected de10_lite, de1_soc, de2 or de2_115, got none"),
        ("--board de0", "board: expected de10_lite, de1_soc, de2 or de2_115, got de0 (did you mean de2?)"),
        ("--board de2 --colour-bits 9", "colour_bits: "),
        ("--board de2 --engine beam", "engine: the boards' projects run at 50 MHz, but the beam engine needs"),
        ("--board de2 --output file", "file"),
        ("--board de2 --output .", "has files in it"),
    ],
    "bitstream": [
        ("--board ice40", "board: expected colorlight_i9, icebreaker, icepi_zero, "),
        ("nowhere.toml", "nowhere.toml: cannot be read"),
        ("--game mine.toml", "game: the game sets up its own scene; leave out the scene, --fix and --fit"),
        ("--game --fix all", "game: the game sets up its own scene; leave out the scene, --fix and --fit"),
        ("--output file", "file"),
    ],
    "fit boxes": [
        ("--fps 75", "240 rows are shown at 60 frames per second, not 75"),
        ("--fix some", "fix: expected rects or all, got some"),
        ("--error -1", "error: expected per cent of the pixels, 0 to 100, got -1"),
    ],
    "area": [
        ("--family ice40", "family: expected one of ecp5, cycloneive, cyclonev, got ice40"),
        ("--features --engine beam", "features: counts a fixed set of designs"),
        ("--features --route-only", "features: counts a fixed set of designs"),
    ],
    "verify upsets": [
        ("--cases 0", "argument --cases: invalid positive value: '0'"),
        ("--engine exact --bus apb", "bus: verify upsets drives the registers itself"),
        ("--build file", "file"),
    ],
    "verify coverage": [("--build file", "file")],
    "sim boxes": [("--build file", "file")],
    "trace boxes": [("PIXEL=1,1 --build file", "file")],
    "wave boxes": [("--screen tiny --build /proc/x", "/proc/x")],
}
"""Options of each command, and the complaint."""

DVI = [
    ("mine.toml --colour-bits 4", "colour_bits: a DVI link carries 8 bits"),
    ("mine.toml --engine beam --screen play", "screen: play is for simulation only; leave it"),
]
LATE = {
    "bitstream": DVI,
    "verify dvi": DVI,
    "verify soak": [("--build file", "file")],
    "fit boxes": [("--error 0.0001 --engine seed --fraction-bits 0", "no design shows ")],
}
"""Mistakes that show once the command has announced its work."""


@pytest.fixture
def directory(tmp_path: Path, monkeypatch) -> Path:
    """Return a user's directory with a scene, a file, and directories that no command made."""
    monkeypatch.delenv(MODELS_VARIABLE)
    for name in ("mine/thesis", "mine.toml", "de2/boxes.toml", "file"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(FLOOR_SCENE)
    return tmp_path


@pytest.mark.parametrize(("text", "options", "complaint"), OF_SCENES)
def test_a_mistake_in_a_scene_gets_one_line(directory, text, options, complaint):
    (directory / "mine.toml").write_text(text)
    assert complaint in refusal(directory, "sim", "mine.toml", *options.split())


@pytest.mark.parametrize(
    ("words", "complaint", "late"),
    [
        pytest.param(f"{command} {options}", complaint, table is LATE, id=f"{command} {options}"[:70])
        for table in (OF_COMMANDS, LATE)
        for command, rows in table.items()
        for options, complaint in rows
    ],
)
def test_a_mistake_gets_one_line(directory, words, complaint, late):
    assert complaint in refusal(directory, *words.split(), late=late)


@pytest.mark.parametrize(
    ("simulator", "present", "missing"),
    [
        ("icarus", "", "Icarus Verilog is missing; install it"),
        ("verilator", "perl", "g++ is missing"),
        ("verilator", "g++", "perl is missing"),
    ],
)
def test_missing_programs_are_named(directory, tmp_path_factory, monkeypatch, simulator, present, missing):
    tools = tmp_path_factory.mktemp("bin")
    for tool in present.split():
        (tools / tool).symlink_to(shutil.which(tool))
    monkeypatch.setenv("PATH", str(tools))
    assert missing in refusal(directory, "sim", "floor", "--simulator", simulator)
