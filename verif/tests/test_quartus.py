# SPDX-License-Identifier: MIT
"""Quartus projects without Quartus: written for every board and checked with Yosys, simulators and Tcl."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import SMALL_SCENE, refused, run_tool
from tcl import compare_calls, tcl_calls

from raycaster.configuration import configure
from raycaster.convert.take_home import WAIVERS
from raycaster.fpga import quartus
from raycaster.fpga.board import TOP, QuartusBoard, board_names, find_board
from raycaster.fpga.quartus import top_of, write_project
from raycaster.rtl.system.scene_player import BUTTONS
from raycaster.scene import load_scene
from raycaster.tools import run_yosys

SMALL = {"screen": "tiny", "units": 2, "rectangles": 3, "allow_underrun": True}
SMALL_WORDS = ("--screen=tiny", "--units=2", "--rectangles=3", "--allow-underrun")

BOARDS = board_names(QuartusBoard)


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
    # Each port has a constraint, and no constraint is for another port.
    named = [word[len("[get_ports ") : -1] for call in calls for word in call if word.startswith("[get_ports ")]
    assert ports == {port for found in named for port in found.strip("{}").split()}
    compare_calls(f"quartus_{name}", calls, () if name == "de2" else settings("de2", tmp_path / "de2")[1])


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
    widths = {port: len(value["bits"]) for port, value in ports.items()}
    used = [(port, list(board.bits(port).items())[:width]) for port, width in widths.items()]
    assert [len(taken) for _, taken in used] == list(widths.values())
    expected = [["set_location_assignment", f"PIN_{pin}", "-to", bit] for _, taken in used for bit, pin in taken]
    expected += [
        ["set_instance_assignment", "-name", "IO_STANDARD", board.signals[port].standard, "-to", bit]
        for port, taken in used
        for bit, _ in taken
    ]
    assert sorted(call for call in calls if "-to" in call) == sorted(expected)

    # The constraints' pixel clock is this register.
    if board.dac_clock:
        generator = (directory / quartus.VERILOG / "video_generator.v").read_text()
        assert re.search(r"^reg pixel_end;$", generator, re.M)
        assert re.search(r"^assign vga_clk = pixel_end;$", generator, re.M)

    parameter = f"COLOUR_BITS={bits}"
    built = ("iverilog", "-g2005", "-Wall", "-s", TOP, f"-P{TOP}.{parameter}", "-o", "a.out")
    assert not run_tool(directory, *built, *files).stdout
    lint = ("verilator", "--lint-only", "--top-module", TOP, f"-G{parameter}", str(WAIVERS))
    done = run_tool(directory, *lint, *files)
    assert (done.returncode, re.findall("^%.*", done.stdout, re.M)) == (0, [])


BENCH = """
module scene_system (
    input wire clk, input wire ready, input wire [5:0] buttons,
    output wire [{bits}-1:0] vga_r, output wire [{bits}-1:0] vga_g, output wire [{bits}-1:0] vga_b,
    output reg vga_hs, output reg vga_vs, output reg vga_blank_n, output reg vga_sync_n, output reg vga_clk
);
assign vga_r = ~0;
assign vga_g = 1 << {bits} - 1;
assign vga_b = 0;
endmodule

module bench;
    reg clk;
    reg [{keys}-1:0] key = ~0;
    reg [{switches}-1:0] sw = 0;
    wire [{pins}-1:0] red, green, blue;
    wire {outputs};
    integer i;
    ray_caster_project #(.COLOUR_BITS({bits})) dut (.{clock}(clk), .KEY(key), .SW(sw), .VGA_R(red), .VGA_G(green),
        .VGA_B(blue), {connections});
    initial begin
        #1 $display("%h %h %h", red, green, blue);
        for (i = 0; i < 32; i = i + 1) begin
            {{dut.system.vga_hs, dut.system.vga_vs, dut.system.vga_blank_n, dut.system.vga_sync_n, dut.system.vga_clk}}
                = i;
            clk = i;
            #1 if ({{{outputs}, dut.system.clk}} !== {{{driven}, clk}}) $display("wrong %0d", i);
        end
        {tried}
    end
endmodule
"""
"""System that only has ports, and a bench that tries each single output and then some states of the controls."""

DRIVES = {"BLANK": "blank_n", "SYNC": "sync_n"}
"""Output of the system, by the top's output without the prefix VGA, if the names differ."""


@pytest.mark.parametrize(
    ("name", "bits", "colours"),
    [
        ("de2", 8, "3ff 202 000"),
        ("de2", 3, "3ff 249 000"),
        ("de2_115", 8, "ff 80 00"),
        ("de1_soc", 1, "ff ff 00"),
        ("de10_lite", 4, "f 8 0"),
        ("de10_lite", 8, "f 8 0"),
    ],
)
def test_the_top_connects_what_it_says(name, bits, colours, tmp_path):
    """Each key and switch alone has the effect in the board's description, and no other has any."""
    board = find_board(name, QuartusBoard)
    top = top_of(board)
    widths = {port: int(highest) + 1 for highest, port in re.findall(r"\[(\d+):0\] +(\w+)", top)}
    outputs = re.findall(r"output wire +VGA_(\w+)", top)
    pressed = {bit.removeprefix("~"): does for does, bit in board.inputs.items()}
    controls = [None, *(f"{port}[{bit}]" for port in ("KEY", "SW") for bit in range(widths[port]))]
    tried = [f"key = ~0; sw = 0; {f'{one.lower()} = ~{one.lower()};' if one else ''}" for one in controls]
    bench = BENCH.format(
        bits=bits, clock=board.clock, keys=widths["KEY"], switches=widths["SW"], pins=widths["VGA_R"],
        outputs=", ".join(outputs),
        connections=", ".join(f".VGA_{output}({output})" for output in outputs),
        driven=", ".join(f"dut.system.vga_{DRIVES.get(output, output.lower())}" for output in outputs),
        tried="\n".join(f'{one} #1 $display("%b %b", dut.system.ready, dut.system.buttons);' for one in tried),
    )  # fmt: skip
    for file, text in {"top.v": top, "bench.v": bench}.items():
        (tmp_path / file).write_text(text)
    command = "iverilog -g2005 -s bench -o a.out bench.v top.v"
    assert not run_tool(tmp_path, *command.split(), str(quartus.HELPER)).stdout
    said = run_tool(tmp_path, "vvp", "-N", "a.out").stdout.splitlines()
    does = [pressed.get(control) for control in controls]
    assert sorted(filter(None, does)) == sorted([*BUTTONS, "reset"])
    effects = [f"{int(one != 'reset')} {1 << BUTTONS.index(one) if one in BUTTONS else 0:06b}" for one in does]
    assert said == [colours, *effects]


@pytest.mark.parametrize(
    ("script", "complaint", "logged"),
    [
        (None, "quartus_sh is not on the path, and the Terasic DE2 needs Quartus II 13.0sp1 or older; the project is "
         "{directory}/ray_caster_project.qpf", None),
        ('echo "Info: so far so good"; echo "    Error (12007): Top-level design entity"; exit 3',
         "Quartus failed, see {directory}/quartus.log: Error (12007): Top-level design entity", "so far so good"),
        ("exit 3", "Quartus failed, see {directory}/quartus.log: exit code 3", ""),
        ("sleep 60", "Quartus took more than 0.0 hours on {directory}/ray_caster_project.qpf", None),
    ],
    ids=["missing", "fails", "fails without a word", "takes too long"],
)  # fmt: skip
def test_quartus_fails(script, complaint, logged, without_hardware, stand_in, monkeypatch, tmp_path):
    """The project is written, and one line gives the reason."""
    monkeypatch.setattr(quartus, "TIMEOUT", 0.5)
    if script:
        stand_in("quartus_sh", script)
    directory = tmp_path / "quartus" / "de2"
    words = (str(SMALL_SCENE), "--board=de2", *SMALL_WORDS, "--output", str(directory.parent))
    assert refused(quartus.main, *words) == f"error: {complaint.format(directory=directory)}\n"
    assert (directory / f"{TOP}.qpf").read_text() == f'PROJECT_REVISION = "{TOP}"\n'
    assert logged is None or logged in (directory / "quartus.log").read_text()


def test_quartus_runs(without_hardware, stand_in, tmp_path, capsys):
    """Quartus compiles the project; options override the board's own, and each run replaces the whole project."""
    stand_in("quartus_sh", 'pwd > said; echo "$@" >> said')
    directory = tmp_path / "de10_lite"
    for bits in (4, 2):
        options = () if bits == 4 else (f"--colour-bits={bits}",)
        words = (str(SMALL_SCENE), "--board=de10_lite", *SMALL_WORDS, "--output", str(tmp_path))
        quartus.main([*words, *options])
        assert capsys.readouterr().out.splitlines()[-1] == str(directory / quartus.OUTPUT_FILES / f"{TOP}.sof")
        assert (directory / "said").read_text() == f"{directory}\n--flow compile {TOP}\n"
        assert f"-name COLOUR_BITS {bits}\n" in (directory / f"{TOP}.qsf").read_text()
        assert not (directory / "older").exists()
        (directory / "older").touch()
