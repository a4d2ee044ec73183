# SPDX-License-Identifier: MIT
"""Descriptions of boards, the pin files made from them, PLLs, and the choice of products that become logic."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from raycaster.configuration import configure
from raycaster.errors import UserError
from raycaster.fpga.bitstream import left_to_logic, top_of
from raycaster.fpga.board import Board, BoardError, OpenBoard, board_names, find_board, load_board
from raycaster.fpga.flows import FLOWS, clocks_for
from raycaster.tools import run_yosys

BOARDS = [find_board(name, OpenBoard) for name in board_names(OpenBoard)]


def changed(name: str, directory: Path, right: str, wrong: str) -> Board:
    """Load a board with a text of its description replaced."""
    shutil.copytree(find_board(name, Board).directory, directory / name)
    path = directory / name / "board.toml"
    assert right in path.read_text()
    path.write_text(path.read_text().replace(right, wrong))
    return load_board(directory / name)


@pytest.mark.parametrize(
    ("name", "pins"),
    [
        ("ulx3s", {"wifi_gpio0": "L2"}),
        ("icepi_zero", {"clk50": "M1", "gpdi[0]": "R13", "gpdi[1]": "R15", "gpdi[2]": "P16", "gpdi[3]": "R12"}),
        ("tang_nano_20k", {"hdmi_p[0]": "35", "hdmi_n[0]": "36", "hdmi_p[3]": "33"}),
        ("de2", {"CLOCK_50": "N2", "KEY[0]": "G26", "VGA_CLK": "B8", "VGA_BLANK": "D6"}),
        ("de2_115", {"VGA_CLK": "A12", "VGA_BLANK_N": "F11", "VGA_HS": "G13", "VGA_VS": "C13"}),
        ("de1_soc", {"VGA_CLK": "A11", "VGA_SYNC_N": "C10", "VGA_BLANK_N": "F10", "VGA_R[7]": "F13"}),
    ],
)
def test_pins_that_are_known_otherwise(name, pins):
    """The other pins are compared with LiteX-Boards."""
    assert find_board(name, Board).pins.items() >= pins.items()


PIN_FILES = {
    "lpf": (r'^LOCATE COMP "(\S+)" SITE "(\w+)";$', r'^IOBUF PORT "(\S+)" IO_TYPE=\w'),
    "pcf": (r"^set_io (?:-\w+ \w+ )*(\S+) (\w+) ", r"^set_io (\S+) .*# LV"),
    "cst": (r'^IO_LOC "(\S+)" (\w+);$', r'^IO_PORT "(\S+)" \w+='),
}
"""Lines with a pin and with a standard, by suffix of the pin file."""


def test_each_port_has_a_pin_and_a_standard(tmp_path):
    """The ports are those of the generated tops, as Yosys reads them; each top has the Verilog of its video."""
    for board in BOARDS:
        config = configure(**board.configuration)
        (tmp_path / f"{board.name}.v").write_text(top_of(board, config))
    run_yosys(tmp_path, "read", [*(f"read_verilog {board.name}.v" for board in BOARDS), "write_json tops.json"])
    tops = json.loads((tmp_path / "tops.json").read_text())["modules"]
    for board in BOARDS:
        suffix, write = FLOWS[board.flow].pin_file
        pins, standards = (re.findall(pattern, write(board), re.M) for pattern in PIN_FILES[suffix])
        bits = {bit for port in tops[board.name]["ports"] for bit in board.bits(port)}
        assert dict(pins) == {bit: board.pins[bit] for bit in bits} == board.pins
        assert set(standards) == bits
        widths = {port: len(found["bits"]) for port, found in tops[board.name]["ports"].items()}
        assert widths == {port: len(board.bits(port)) for port in board.signals}


@pytest.mark.parametrize(
    ("name", "right", "wrong", "complaint"),
    [
        ("icepi_zero", 'pins = "K15"', 'pins = "R13"', "R13 is both gpdi[0] and serial_tx"),
        ("icepi_zero", 'pins = "K15"', 'pins = "15K"', 'serial_tx.pins: must be a pin such as "N2", not "15K"'),
        ("icepi_zero", '{ standard = "LVCMOS33", options = { DRIVE = "4" }, pins = "K15"', '{ pins = "K15"',
         "serial_tx.standard: expected"),
        ("icepi_zero", 'serial_tx = "serial"', 'serial_rx = "serial"', "outputs: serial_rx is not among the signals"),
        ("icepi_zero", 'serial_tx = "serial"', "", "serial_tx is neither the clock nor used in inputs or outputs"),
        ("icepi_zero", '"~gpio[3]"', '"~gpio[4]"', "down: ~gpio[4] is not a bit of a signal here, or is an output"),
        ("icepi_zero", '"~gpio[3]"', '"gpdi[3]"', "down: gpdi[3] is not a bit of a signal here, or is an output"),
        ("icepi_zero", "down =", "fire =", "inputs: fire is not one of reset, forward, back, left, right, up, down"),
        ("icepi_zero", 'clock = "clk50"', 'clock = "clk"', "clk is missing, but is one of the board's clocks"),
        ("icepi_zero", 'flow = "ecp5"', 'flow = "ecp4"', "expected ecp5, ice40 or gowin, got ecp4 (did you"),
        ("icepi_zero", 'flow = "ecp5"', 'flow = "', "is not TOML"),
        ("icepi_zero", 'PULLMODE = "NONE"', 'PULLMODE = ["NONE", "UP"]', "PULLMODE has 2 values for"),
        ("de10_lite", '["B8", "A7"]', "[]", 'signals.KEY.pins: must be a pin such as "N2", or a list of them'),
        ("de2", 'dac_clock = "VGA_CLK"', 'dac_clock = "DAC"', "DAC is missing, but is one of the board's clocks"),
        ("de10_lite", 'VGA_HS = "vga_hs"', 'VGA_HS = "hs"', "outputs: hs is not one of vga_r, "),
        ("de10_lite", 'VGA_R = "vga_r"', "", "outputs: none is vga_r"),
        ("de10_lite", "family =", "familiy =", "familiy: is unknown (did you mean family?)"),
    ],
)  # fmt: skip
def test_a_wrong_description_is_refused(tmp_path, name, right, wrong, complaint):
    """One line gives the file and the mistake."""
    with pytest.raises(BoardError, match=rf"board\.toml: .*{re.escape(complaint)}") as error:
        changed(name, tmp_path, right, wrong)
    assert "\n" not in str(error.value)


def test_a_description_is_missing(tmp_path):
    with pytest.raises(BoardError, match=r"board\.toml: cannot be read: No such file or directory$"):
        load_board(tmp_path)


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
    ("mhz", "options", "complaint"),
    [
        (12, {}, "^rows: the .* takes one clock per pixel; choose ROWS=120, 96 or 60, or ENGINE=beam$"),
        (12, {"engine": "beam", "screen": "play"}, "^screen: play is for simulation only"),
        (12, {"engine": "beam", "rows": 180, "scale": 6, "pixels": 2}, "^pixels: "),
        (9, {"engine": "exact", "rows": 60}, "^screen: the .* makes no pixel clock near 25 MHz; choose other ROWS$"),
    ],
)
def test_unsupported_clocks(mhz, options, complaint):
    board = find_board("icebreaker", OpenBoard).model_copy(update={"clock_mhz": mhz})
    with pytest.raises(UserError, match=complaint):
        clocks_for(board, configure(**options))


def test_the_smallest_products_are_left_to_logic():
    """Products of one size go by name; a product wider than a factor takes more than one multiplier."""
    cells = (("a", 9, 9), ("b", 20, 9), ("c", 9, 8), ("d", 8, 9), ("e", 3, 3))
    text = "".join(
        f"  cell $mul \\{name}\n    parameter \\A_SIGNED 0\n"
        f"    parameter \\A_WIDTH {a}\n    parameter \\B_WIDTH {b}\n  end\n"
        for name, a, b in cells
    )
    for most, factor_bits, left in ((6, 18, ""), (5, 18, "e"), (4, 18, "ec"), (1, 18, "ecdab"), (4, 20, "e")):
        assert "".join(left_to_logic(text, most, factor_bits)) == left
