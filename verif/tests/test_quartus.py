# SPDX-License-Identifier: MIT
"""Quartus projects without Quartus: written for every board and checked with Yosys, simulators and Tcl."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Mapping
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import pytest
from conftest import SMALL_SCENE
from tcl import run_tcl

from raycaster.configuration import Configuration, configure
from raycaster.convert.take_home import WAIVERS
from raycaster.fpga import quartus
from raycaster.fpga.board import (
    TOP,
    BoardError,
    QuartusBoard,
    assignments,
    board_names,
    check_project,
    find_board,
    load_board,
)  # fmt: skip
from raycaster.fpga.quartus import OUTPUT_FILES, VERILOG, write_project
from raycaster.options import run_command
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.scene import load_scene
from raycaster.sim.simulator import find_tool
from raycaster.tools import run_yosys

SMALL: Mapping[str, Any] = {"screen": "tiny", "units": 2, "rectangles": 3, "allow_underrun": True}

BOARDS = board_names(QuartusBoard)
every_board = pytest.mark.parametrize("name", BOARDS)


def small(board: QuartusBoard, **more: Any) -> Configuration:
    return configure(**board.configuration, **SMALL | more)


def write(board: QuartusBoard, directory: Path, **more: Any) -> Configuration:
    config = configure(**board.configuration | SMALL | more)
    write_project(board, config, load_scene(SMALL_SCENE), directory)
    return config


def sources(directory: Path) -> list[str]:
    return re.findall(r'^set_global_assignment -name VERILOG_FILE "(.*)"$', settings(directory), re.M)


def settings(directory: Path) -> str:
    return (directory / f"{TOP}.qsf").read_text()


def run(directory: Path, *command: str) -> str:
    """Run a program, assert that it succeeds, and return its output."""
    environment = os.environ | dict(find_tool("verilator").environment)
    path = f"{sysconfig.get_path('scripts')}{os.pathsep}{environment['PATH']}"
    done = subprocess.run(
        command, cwd=directory, env=environment | {"PATH": path}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def broken(name: str, directory: Path, file: str, right: str, wrong: str) -> Path:
    """Copy a board's folder with text replaced in one file."""
    shutil.copytree(find_board(name, QuartusBoard).directory, directory / name)
    path = directory / name / file
    text = path.read_text()
    assert right in text
    path.write_text(text.replace(right, wrong))
    return directory / name


@every_board
def test_a_board_has_what_a_project_needs(name):
    board = find_board(name, QuartusBoard)
    small(board)
    for text in (board.title, board.family, board.device, board.quartus, board.source, board.confirmation):
        assert text.strip()
    assert "AS INPUT TRI-STATED" in board.settings.values()


@pytest.mark.parametrize(
    ("name", "pins"),
    [
        ("de2", {"CLOCK_50": "N2", "KEY[0]": "G26", "VGA_CLK": "B8", "VGA_BLANK": "D6"}),
        ("de2_115", {"VGA_CLK": "A12", "VGA_BLANK_N": "F11", "VGA_HS": "G13", "VGA_VS": "C13"}),
        ("de1_soc", {"VGA_CLK": "A11", "VGA_HS": "B11", "VGA_VS": "D11", "VGA_SYNC_N": "C10", "VGA_BLANK_N": "F10"}),
        ("de1_soc", {"VGA_R[7]": "F13"}),
        ("de10_lite", {"MAX10_CLK1_50": "P11", "VGA_HS": "N3", "VGA_VS": "N1"}),
    ],
)
def test_pins_that_are_known_otherwise(name, pins):
    assert find_board(name, QuartusBoard).pins.items() >= pins.items()


@pytest.mark.slow_sets(quick=["de1_soc", "de2_115"])
@pytest.mark.parametrize(
    ("name", "more"),
    [*((name, {}) for name in BOARDS), ("de2", {"colour_bits": 3}), ("de10_lite", {"colour_bits": 8})],
)
def test_tools_have_nothing_to_say(name, more, tmp_path):
    board = find_board(name, QuartusBoard)
    directory = tmp_path / "a project"
    bits = write(board, directory, **more).colour_bits
    files = sources(directory)
    assert {path.relative_to(directory).as_posix() for path in directory.rglob("*.v")} == set(files)
    assert f"\nset_parameter -name COLOUR_BITS {bits}\n" in settings(directory)
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
    expected = {
        f"{port}[{index}]" if len(value["bits"]) > 1 else port
        for port, value in ports.items()
        for index in range(len(value["bits"]))
    }
    given = assignments(settings(directory))
    for kind in ("LOCATION", "IO_STANDARD"):
        assert sorted(bit for said, _, bit in given if said == kind) == sorted(expected)
    assert {bit: pin for kind, pin, bit in given if kind == "LOCATION"}.items() <= board.pins.items()

    parameter = f"{TOP}.COLOUR_BITS={bits}"
    assert not run(directory, "iverilog", "-g2005", "-Wall", "-s", TOP, f"-P{parameter}", "-o", "a.out", *files)
    lint = ("verilator", "--lint-only", "--top-module", TOP, f"-GCOLOUR_BITS={bits}", str(WAIVERS))
    assert not re.findall("^%.*", run(directory, *lint, *files), re.M)


@pytest.mark.parametrize(
    ("file", "right", "wrong", "complaint"),
    [
        ("board.toml", '["B8", "A7"]', '["B8"]', "KEY[1] has no pin; KEY[1] has no I/O standard"),
        (f"{TOP}.v", "[1:0] KEY", "[1:0] KEYS", "KEYS[0] has no pin; KEYS[1] has no pin; KEYS[0] has no I/O standard"),
        (f"{TOP}.v", f"module {TOP}", "module other", f"the top has no module {TOP} with parameters and ports"),
        (f"{TOP}.v", "output wire       VGA_HS", "output reg VGA_HS", "cannot be read: output reg VGA_HS,"),
    ],
)
def test_a_broken_board_is_not_written(file, right, wrong, complaint, tmp_path):
    directory = tmp_path / "output" / "project"
    directory.mkdir(parents=True)
    (directory / "older").touch()
    board = load_board(broken("de10_lite", tmp_path, file, right, wrong))
    with pytest.raises(BoardError, match=re.escape(complaint)) as raised:
        write(board, directory)
    assert "\n" not in str(raised.value)
    assert [path.name for path in directory.parent.rglob("*")] == ["project", "older"]


@pytest.fixture(scope="module")
def qsf(tmp_path_factory) -> str:
    """The settings file of a project for the DE10-Lite."""
    directory = tmp_path_factory.mktemp("qsf") / "project"
    write(find_board("de10_lite", QuartusBoard), directory)
    return settings(directory)


@pytest.mark.parametrize(
    ("right", "wrong", "complaint"),
    [
        ("set_location_assignment PIN_B8 -to KEY[0]\n", "", "KEY[0] has no pin"),
        (
            'set_instance_assignment -name IO_STANDARD "3.3 V SCHMITT TRIGGER" -to KEY[0]\n',
            "",
            "KEY[0] has no I/O standard",
        ),
        ("PIN_A7 -to KEY[1]", "PIN_B8 -to KEY[1]", "B8 is both KEY[0] and KEY[1]"),
        ("PIN_B8 -to KEY[0]", "PIN_AC9 -to KEY[0]", "KEY[0] is on AC9, which is not among the board's pins"),
        ("PIN_B8 -to KEY[0]", "PIN_N14 -to KEY[0]", "KEY[0] is on N14, which is the board's MAX10_CLK2_50"),
        ("PIN_B8 -to KEY[0]", "PIN_B8 -to KEY[2]", "KEY[0] has no pin; KEY[2] is not a port; "),
        ('TRIGGER" -to KEY[1]', 'TRIGGER" -to KEY1', "KEY[1] has no I/O standard; KEY1 is not a port"),
    ],
)
def test_a_broken_settings_file_is_noticed(right, wrong, complaint, qsf):
    board = find_board("de10_lite", QuartusBoard)
    top = (board.directory / board.top).read_text()
    check_project(board, top, qsf)
    assert qsf.count(right) == 1
    with pytest.raises(BoardError) as raised:
        check_project(board, top, qsf.replace(right, wrong))
    assert str(raised.value).startswith(f"{TOP} on the Terasic DE10-Lite: {complaint}")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("right", "wrong", "complaint"),
    [
        ('"B8", "A7"', '"B8", "N3"', "signals: N3 is both KEY[1] and VGA_HS"),
        ('"B8", "A7"', '"B8", "PIN_A7"', 'signals.KEY.pins: must be a pin such as "N2", not "PIN_A7"'),
        ('["B8", "A7"]', "[]", 'signals.KEY.pins: must be a pin such as "N2", or a list of them'),
        ('clock = "MAX10_CLK1_50"', 'clock = "CLOCK"', "signals: CLOCK is missing, but is one of the board's clocks"),
        ("family =", "familiy =", "familiy: is unknown (did you mean family?)"),
        ("[settings]", "[settings", "is not TOML: "),
    ],
)
def test_a_description_is_refused(right, wrong, complaint, tmp_path):
    folder = broken("de10_lite", tmp_path, "board.toml", right, wrong)
    with pytest.raises(BoardError) as raised:
        load_board(folder)
    assert str(raised.value).startswith(f"{folder / 'board.toml'}: {complaint}")
    assert "\n" not in str(raised.value)


def test_a_description_is_missing(tmp_path):
    with pytest.raises(BoardError, match=r"board\.toml: cannot be read: No such file or directory$"):
        load_board(tmp_path)


@pytest.mark.slow
def test_a_project_is_replaced_as_a_whole(tmp_path):
    board = find_board("de10_lite", QuartusBoard)
    directory = tmp_path / "project"
    write(board, directory)
    before = {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()}
    (directory / "older").touch()
    write(board, directory)
    assert {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()} == before
    assert [path.name for path in tmp_path.iterdir()] == ["project"]


TCL = """
foreach name {create_clock create_generated_clock derive_clock_uncertainty get_clocks set_false_path set_output_delay
              set_multicycle_path set_max_delay set_min_delay} {
    proc $name args {}
}
foreach kind {get_ports get_registers} {
    proc $kind patterns "foreach pattern \\$patterns { puts \\"$kind \\$pattern\\" }; return \\$patterns"
}
source [lindex $argv 0]
"""


@pytest.mark.slow_sets("de10_lite", "de2_115")
@every_board
def test_constraints_are_tcl_of_these_ports(name, tmp_path):
    board = find_board(name, QuartusBoard)
    directory = tmp_path / "project"
    write(board, directory)
    done = run_tcl(tmp_path, TCL, str(directory / f"{TOP}.sdc"))
    assert (done.returncode, done.stderr) == (0, "")
    named = [line.split() for line in done.stdout.splitlines()]
    bits = {bit for kind, _, bit in assignments(settings(directory)) if kind == "LOCATION"}
    met = set()
    for pattern in (value for kind, value in named if kind == "get_ports"):
        found = {bit for bit in bits if fnmatch(bit, pattern.replace("[", "[[]"))}
        assert found, f"no port is {pattern}"
        met |= found
    assert met == bits
    registers = {value for kind, value in named if kind == "get_registers"}
    assert registers == (set() if board.dac_clock is None else {"*|video_generator:*|pixel_end"})
    # The register by that name is the pixel clock.
    generator = (directory / VERILOG / "video_generator.v").read_text()
    assert re.search(r"^reg pixel_end;$", generator, re.M)
    assert re.search(r"^assign vga_clk = pixel_end;$", generator, re.M)
    assert configure().screen_geometry.clocks_per_pixel == 2


SYSTEM = """
module scene_system (
    input wire clk, input wire ready, input wire [5:0] buttons,
    output wire [{bits}-1:0] vga_r, output wire [{bits}-1:0] vga_g, output wire [{bits}-1:0] vga_b,
    output wire vga_hs, output wire vga_vs, output wire vga_blank_n, output wire vga_sync_n, output wire vga_clk
);
assign vga_r = ~0;
assign vga_g = 1 << {bits} - 1;
assign vga_b = 0;
assign {{vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk}} = 0;
endmodule
"""

WIRING = """
module bench;
    reg [{keys}-1:0] key;
    reg [{switches}-1:0] sw;
    wire [{pins}-1:0] red, green, blue;
    integer i;
    ray_caster_project #(.COLOUR_BITS({bits})) dut (.{clock}(1'b0), .KEY(key), .SW(sw), .VGA_R(red), .VGA_G(green),
        .VGA_B(blue));
    initial begin
        key = ~0;
        sw = 0;
        #1 $display("none %b %b", dut.system.ready, dut.system.buttons);
        $display("colours %h %h %h", red, green, blue);
        for (i = 0; i < {keys}; i = i + 1) begin
            key = ~(1 << i);
            #1 $display("KEY[%0d] %b %b", i, dut.system.ready, dut.system.buttons);
        end
        key = ~0;
        for (i = 0; i < {switches}; i = i + 1) begin
            sw = 1 << i;
            #1 $display("SW[%0d] %b %b", i, dut.system.ready, dut.system.buttons);
        end
    end
endmodule
"""


@pytest.mark.parametrize(
    ("name", "bits", "colours"),
    [
        ("de2", 8, "3ff 202 000"),
        ("de2", 3, "3ff 249 000"),
        ("de2_115", 8, "ff 80 00"),
        ("de1_soc", 8, "ff 80 00"),
        ("de1_soc", 1, "ff ff 00"),
        ("de10_lite", 4, "f 8 0"),
        ("de10_lite", 8, "f 8 0"),
    ],
)
def test_the_top_connects_what_it_says(name, bits, colours, tmp_path):
    board = find_board(name, QuartusBoard)
    path = board.directory / board.top
    top = path.read_text()
    widths = {port: int(highest) + 1 for highest, port in re.findall(r"\[(\d+):0\] +(\w+)", top)}
    (tmp_path / "system.v").write_text(SYSTEM.format(bits=bits))
    (tmp_path / "bench.v").write_text(
        WIRING.format(bits=bits, clock=board.clock, keys=widths["KEY"], switches=widths["SW"], pins=widths["VGA_R"])
    )
    files = ["bench.v", "system.v", str(path), str(quartus.HELPER)]
    run(tmp_path, "iverilog", "-g2005", "-s", "bench", "-o", "a.out", *files)
    said = dict(line.split(" ", 1) for line in run(tmp_path, "vvp", "-N", "a.out").splitlines())
    assert said.pop("colours") == colours
    assert said.pop("none") == "1 000000"
    assert said.pop("SW[2]") == "0 000000"
    # The comment at the top, for human readers, must match the wiring.
    comment = "".join(re.findall("^// (?:KEY|SW).*", top, re.M))
    promised = dict(re.findall(rf"((?:KEY|SW)\[\d\]) ({'|'.join(BUTTONS)})", comment))
    assert sorted(promised.values()) == sorted(BUTTONS)
    assert said == {control: f"1 {1 << BUTTONS.index(does):06b}" for control, does in promised.items()}


WHOLE = """
`timescale 1ns/10ps
module bench;
    reg clk = 0;
    reg [4:0] sw = 4;
    wire [3:0] red, green, blue;
    wire hs, vs;
    integer different = 0, lit = 0, frames = 0, lines = 0, cycle;
    always #10 clk = !clk;
    always @(negedge vs) if (!sw[2]) frames = frames + 1;
    always @(negedge hs) if (!sw[2]) lines = lines + 1;
    ray_caster_project dut (.MAX10_CLK1_50(clk), .KEY(2'b11), .SW(sw), .VGA_R(red), .VGA_G(green), .VGA_B(blue),
        .VGA_HS(hs), .VGA_VS(vs));
    initial begin
        for (cycle = 0; cycle < %d; cycle = cycle + 1) begin
            @(negedge clk);
            if (cycle == 20) sw[2] = 0;
            if (cycle >= 20) begin
                if ({red, green, blue, hs, vs} !== {dut.system.vga_r, dut.system.vga_g, dut.system.vga_b,
                    dut.system.vga_hs, dut.system.vga_vs}) different = different + 1;
                if (red != 0) lit = lit + 1;
            end
        end
        $display("different %%0d, lit %%0d, frames %%0d, lines %%0d", different, lit, frames, lines);
        $finish;
    end
endmodule
"""


@pytest.mark.slow
def test_a_board_shows_what_the_system_does(tmp_path):
    directory = tmp_path / "project"
    screen = write(find_board("de10_lite", QuartusBoard), directory).screen_geometry
    frames = 3
    (directory / "bench.v").write_text(WHOLE % (frames * screen.frame_cycles))
    run(directory, "iverilog", "-g2005", "-s", "bench", "-o", "a.out", *sources(directory), "bench.v")
    said = run(directory, "vvp", "-N", "a.out").splitlines()[-1]
    different, lit, seen, lines = map(int, re.findall(r"\d+", said))
    assert (different, seen) == (0, frames)
    assert lines >= frames * screen.vertical.total - 1
    # The small scene has red everywhere, its background included.
    assert lit >= screen.horizontal.visible * screen.vertical.visible * screen.clocks_per_pixel


Command = Callable[..., tuple[int, list[str], list[str]]]


@pytest.fixture
def command(monkeypatch, capsys, tmp_path) -> Command:
    """Return a function that runs the command with a minimal PATH and returns its exit code, output and errors."""
    monkeypatch.setattr("raycaster.tools._search_path", lambda: f"{tmp_path / 'bin'}:/usr/bin:/bin")

    def run_it(*arguments: str, name: str = "de2", scene: Path = SMALL_SCENE) -> tuple[int, list[str], list[str]]:
        small_design = [str(scene), "--screen=tiny", "--units=2", "--rectangles=3", "--allow-underrun"]
        output = ["--output", str(tmp_path / "quartus")]
        monkeypatch.setattr(sys, "argv", ["quartus", "--board", name, *small_design, *output, *arguments])
        with pytest.raises(SystemExit) as exited:
            run_command(quartus.main)
        captured = capsys.readouterr()
        return int(exited.value.code or 0), captured.out.splitlines(), captured.err.splitlines()

    return run_it


def stand_in(directory: Path, script: str) -> None:
    """Write a script with the name of Quartus."""
    path = directory / "bin" / "quartus_sh"
    path.parent.mkdir()
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)


def test_without_quartus(command, tmp_path):
    code, out, err = command()
    project = tmp_path / "quartus" / "de2" / TOP
    assert (code, out) == (2, [])
    assert err == [
        "error: quartus_sh is not on the path, and the Terasic DE2 needs Quartus II 13.0sp1 or older; "
        f"the project is {project}.qpf"
    ]
    assert project.with_suffix(".qpf").read_text() == f'PROJECT_REVISION = "{TOP}"\n'


def test_with_quartus(command, tmp_path):
    stand_in(tmp_path, 'pwd > said; echo "$@" >> said')
    code, out, err = command()
    directory = tmp_path / "quartus" / "de2"
    assert (code, err) == (0, [])
    assert out[-1] == str(directory / OUTPUT_FILES / f"{TOP}.sof")
    assert (directory / "said").read_text() == f"{directory}\n--flow compile {TOP}\n"


def test_quartus_fails(command, tmp_path):
    stand_in(tmp_path, 'echo "Info: so far so good"; echo "    Error (12007): Top-level design entity"; exit 3')
    code, _, err = command()
    log = tmp_path / "quartus" / "de2" / "quartus.log"
    assert (code, err) == (2, [f"error: Quartus failed, see {log}: Error (12007): Top-level design entity"])
    assert "so far so good" in log.read_text()


@pytest.mark.slow
def test_quartus_fails_without_a_word(command, tmp_path):
    stand_in(tmp_path, "exit 3")
    code, _, err = command()
    assert code == 2
    assert err[0].endswith("quartus.log: exit code 3")


@pytest.mark.slow
def test_quartus_takes_too_long(command, tmp_path, monkeypatch):
    stand_in(tmp_path, "sleep 60")
    monkeypatch.setattr(quartus, "TIMEOUT", 0.5)
    code, _, err = command()
    assert (code, len(err)) == (2, 1)
    assert "Quartus took more than" in err[0]


def test_mistakes_get_one_line(command, tmp_path):
    assert command(name="de0") == (
        2,
        [],
        ["error: board: expected de10_lite, de1_soc, de2 or de2_115, got de0 (did you mean de2?)"],
    )
    code, _, err = command(scene=tmp_path / "none.toml")
    assert (code, err) == (2, [f"error: {tmp_path / 'none.toml'}: cannot be read: No such file or directory"])
    code, _, err = command("--colour-bits", "9")
    assert (code, len(err)) == (2, 1)
    assert not (tmp_path / "quartus").exists()


def test_the_board_sets_the_default_options(command, tmp_path):
    qsf = tmp_path / "quartus" / "de10_lite" / f"{TOP}.qsf"
    command(name="de10_lite")
    assert "-name COLOUR_BITS 4\n" in qsf.read_text()
    command("--colour-bits", "2", name="de10_lite")
    assert "-name COLOUR_BITS 2\n" in qsf.read_text()


def test_the_module_runs():
    done = subprocess.run(
        [sys.executable, "-m", "raycaster.cli", "quartus", "--help"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert "--board" in done.stdout
