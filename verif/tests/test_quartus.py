# SPDX-License-Identifier: MIT
"""Quartus projects without Quartus: written for every board and checked with Yosys, simulators and Tcl."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import SMALL_SCENE, run_tool
from tcl import compare_calls, tcl_calls

from raycaster.convert.take_home import waivers
from raycaster.design.decide import configure
from raycaster.fpga import quartus
from raycaster.fpga.board import TOP, QuartusBoard, board_names, find_board
from raycaster.fpga.quartus import write_project
from raycaster.runs.tools import run_yosys
from raycaster.scene import load_scene

SMALL = {"screen": "tiny", "units": 2, "rectangles": 3, "allow_underrun": True}
SMALL_WORDS = ("--screen=tiny", "--units=2", "--rectangles=3", "--allow-underrun")

BOARDS = board_names(QuartusBoard)
BASE = "de2_115"
"""Board whose commands are kept in full; for the others, the differences are."""


def write(board: QuartusBoard, directory: Path, **more: Any) -> int:
    """Write a small project and return its number of bits per colour."""
    config = configure(**board.configuration | SMALL | more)
    write_project(board, config, load_scene(SMALL_SCENE), directory)
    return config.colour_bits


@pytest.fixture
def without_hardware(monkeypatch) -> None:
    """Write projects without the generated modules, except two names, which takes no time."""
    monkeypatch.setattr(
        quartus, "write_scene_system", lambda config, scene, directory: [directory / "a.v", directory / "system.v"]
    )


def settings(name: str, directory: Path) -> tuple[set[str], list[list[str]]]:
    """Write a board's project; return its ports, and the commands of its files without those for pins."""
    write(find_board(name, QuartusBoard), directory)
    calls = [call for kind in ("qsf", "sdc") for call in tcl_calls(directory, Path(f"{TOP}.{kind}"))]
    ports = {re.sub(r"\d+\]$", "*]", call[-1]) for call in calls if call[0] == "set_location_assignment"}
    return ports, [call for call in calls if call[0] not in ("set_location_assignment", "set_instance_assignment")]


@pytest.mark.parametrize("name", BOARDS)
def test_settings_and_constraints(name, without_hardware, tmp_path):
    """The files are Tcl; except the pins, which another test checks, their commands are those that were reviewed."""
    ports, calls = settings(name, tmp_path / name)
    # The settings are those of the revision that is opened.
    assert (tmp_path / name / f"{TOP}.qpf").read_text() == f'PROJECT_REVISION = "{TOP}"\n'
    # Each port has a constraint, and no constraint is for another port.
    named = [word[len("[get_ports ") : -1] for call in calls for word in call if word.startswith("[get_ports ")]
    assert ports == {port for found in named for port in found.strip("{}").split()}
    compare_calls(f"quartus_{name}", calls, () if name == BASE else settings(BASE, tmp_path / BASE)[1])


@pytest.mark.slow_sets(quick=["de1_soc", "de10_lite-more0"])
@pytest.mark.parametrize(
    ("name", "more"),
    [*((name, {}) for name in BOARDS), ("de2", {"colour_bits": 3}), ("de10_lite", {"colour_bits": 8})],
)
def test_tools_have_nothing_to_say(name, more, tmp_path):
    """Each bit of a port that Yosys finds has the board's pin and standard; other tools accept the project too."""
    board = find_board(name, QuartusBoard)
    directory = tmp_path / "a project"
    bits = write(board, directory, **more)
    calls = tcl_calls(directory, Path(f"{TOP}.qsf"))
    files = [call[3] for call in calls if call[2] == "VERILOG_FILE"]
    assert {path.relative_to(directory).as_posix() for path in directory.rglob("*.v")} == set(files)
    script = [
        *(f"read_verilog {file}" for file in files),
        f"hierarchy -check -top {TOP} -chparam COLOUR_BITS {bits}",
        "proc",
        "check -assert",
        f"select {TOP}",
        "write_json -selected ports.json",
    ]
    run_yosys(directory, "elaborate", script)
    assert "arning" not in (directory / "elaborate.log").read_text()
    ports = json.loads((directory / "ports.json").read_text())["modules"][TOP]["ports"]
    expected = []
    for port, found in ports.items():
        assert len(found["bits"]) == len(board.bits(port))
        for bit, pin in board.bits(port).items():
            expected.append(["set_location_assignment", f"PIN_{pin}", "-to", bit])
            standard = board.signals[port].standard
            expected.append(["set_instance_assignment", "-name", "IO_STANDARD", standard, "-to", bit])
    assert sorted(call for call in calls if "-to" in call) == sorted(expected)

    # The constraints' pixel clock is this register.
    if board.dac_clock:
        generator = (directory / quartus.VERILOG / "video_generator.v").read_text()
        assert re.search(r"^reg pixel_end;$", generator, re.M)
        assert re.search(r"^assign vga_clk = pixel_end;$", generator, re.M)

    parameter = f"COLOUR_BITS={bits}"
    built = ("iverilog", "-g2005", "-Wall", "-s", TOP, f"-P{TOP}.{parameter}", "-o", "a.out")
    assert not run_tool(directory, *built, *files).stdout
    (directory / "waivers.vlt").write_text(waivers([Path(file).name for file in files]))
    lint = ("verilator", "--lint-only", "--top-module", TOP, f"-G{parameter}", "waivers.vlt")
    done = run_tool(directory, *lint, *files)
    assert (done.returncode, re.findall("^%.*", done.stdout, re.M)) == (0, [])


def test_the_command(without_hardware, tmp_path, capsys):
    """Options override the board's own, each run replaces the whole project, and what was not tried is said."""
    project = tmp_path / "de10_lite" / TOP
    for bits in (4, 2):
        options = () if bits == 4 else (f"--colour-bits={bits}",)
        quartus.main([str(SMALL_SCENE), "--board=de10_lite", *SMALL_WORDS, *options, "--output", str(tmp_path)])
        assert capsys.readouterr().out.splitlines()[-1] == (
            f"{project}.qpf was never compiled; it is for Quartus Prime Lite 20.1, or another version for the MAX 10: "
            f"quartus_sh --flow compile {TOP}"
        )
        assert f"-name COLOUR_BITS {bits}\n" in project.with_suffix(".qsf").read_text()
        assert not (project.parent / "older").exists()
        (project.parent / "older").touch()
    quartus.main([str(SMALL_SCENE), "--board=de2", "--output", str(tmp_path)])
    said = "pixel clock: 25 MHz; the standard has 25.175 MHz, and a monitor may refuse this one"
    assert said in capsys.readouterr().out.splitlines()
