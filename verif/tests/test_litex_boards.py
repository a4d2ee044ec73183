# SPDX-License-Identifier: MIT
"""Compare the boards' pins and clocks with LiteX-Boards, which others use on the same boards."""

from __future__ import annotations

import shutil
from importlib import import_module
from pathlib import Path

import pytest
from litex.build.generic_platform import Pins, Subsignal

from raycaster.fpga import board as boards
from raycaster.fpga.board import Board, OpenBoard, find_board, load_board

PLATFORMS = {
    "ulx3s": ("radiona_ulx3s", {"revision": "2.0"}),
    "colorlight_i9": ("colorlight_i5", {"board": "i9", "revision": "7.2"}),
    "icebreaker": ("icebreaker", {}),
    "tang_nano_20k": ("sipeed_tang_nano_20k", {}),
    "de2_115": ("terasic_de2_115", {}),
    "de1_soc": ("terasic_de1soc", {}),
    "de10_lite": ("terasic_de10lite", {}),
}
"""LiteX-Boards module and options by board. It lacks the DE2 and the Icepi Zero."""

GPDI = ["gpdi.data0_p", "gpdi.data1_p", "gpdi.data2_p", "gpdi.clk_p"]
VGA = {f"VGA_{colour.upper()}": f"vga.{colour}" for colour in "rgb"} | {
    "VGA_HS": "vga.hsync_n",
    "VGA_VS": "vga.vsync_n",
}
NAMES: dict[str, dict[str, str | list[str]]] = {
    "ulx3s": {"clk_25mhz": "clk25", "btn": "user_btn", "led": "user_led", "gpdi_dp": GPDI, "ftdi_rxd": "serial.tx"},
    "colorlight_i9": {"clk25": "clk25", "user_led_n": "user_led_n", "gpdi": GPDI, "serial_tx": "serial.tx"},
    "icebreaker": {
        "CLK": "clk12", "BTN_N": "user_btn_n", "LEDG_N": "user_ledg_n", "TX": "serial.tx", "BTN": "user_btn",
        **{f"dvi_{name}": f"dvi.{name}" for name in ("r", "g", "b", "hsync", "vsync", "de", "clk")},
    },
    "tang_nano_20k": {"clk27": "clk27", "btn": "btn", "led_n": "led_n", "serial_tx": "serial.tx"},
    "de2_115": {"CLOCK_50": "clk50", "LEDR": "user_led"},
    "de1_soc": {"CLOCK_50": "clk50", "KEY": "key", "SW": "user_sw", "LEDR": "user_led"} | VGA,
    "de10_lite": {"MAX10_CLK1_50": "clk50", "KEY": "user_btn", "SW": "user_sw", "LEDR": "user_led"} | VGA,
}  # fmt: skip
"""LiteX-Boards names by board and signal, with at least as many pins as the signal has here."""

OTHER = {"de1_soc": {"VGA_R[7]": "F1"}}
"""Pins that differ in LiteX-Boards; the board's description says why LiteX-Boards is not followed."""


def pins_of_litex(name: str) -> tuple[dict[str, list[str]], float]:
    """Return the pins by resource or resource.subsignal, and the default clock's frequency in MHz."""
    module, options = PLATFORMS[name]
    module = import_module(f"litex_boards.platforms.{module}")
    platform = module.Platform(**options)
    if name == "icebreaker":
        platform.add_extension(module.break_off_pmod)
        platform.add_extension(module.dvi_pmod)
    found: dict[str, list[str]] = {}
    resolve = platform.constraint_manager.connector_manager.resolve_identifiers
    for resource, _, *parts in sorted(platform.constraint_manager.available, key=lambda entry: entry[:2]):
        for part in parts:
            if isinstance(part, Pins):
                found.setdefault(resource, []).extend(resolve(part.identifiers))
            elif isinstance(part, Subsignal):
                [pins] = [constraint for constraint in part.constraints if isinstance(constraint, Pins)]
                found.setdefault(f"{resource}.{part.name}", []).extend(resolve(pins.identifiers))
    return found, 1000 / platform.default_clk_period


def differences(board: Board) -> dict[str, str]:
    """Return the LiteX-Boards pin of each bit that differs, and its clock frequency if that differs."""
    theirs, mhz = pins_of_litex(board.name)
    found = {}
    for name, known in NAMES[board.name].items():
        pins = [pin for one in ([known] if isinstance(known, str) else known) for pin in theirs[one]]
        # LiteX-Boards may list further clock pins, which are separate signals here.
        for (bit, pin), their in zip(board.bits(name).items(), pins, strict=False):
            if pin != their:
                found[bit] = their
        assert len(pins) >= len(board.bits(name)), name
    if isinstance(board, OpenBoard) and abs(board.clock_mhz - mhz) > 1e-6:
        found[board.clock] = f"{mhz:g} MHz"
    return found


@pytest.mark.parametrize("name", PLATFORMS)
def test_pins_are_the_same(name):
    assert differences(find_board(name, Board)) == OTHER.get(name, {})


@pytest.mark.parametrize(
    ("name", "right", "wrong", "found"),
    [
        ("ulx3s", '"U1", "H16"', '"H16", "U1"', {"btn[5]": "U1", "btn[6]": "H16"}),
        ("ulx3s", "clock_mhz = 25", "clock_mhz = 24", {"clk_25mhz": "25 MHz"}),
        ("icebreaker", '"44", "45"', '"45", "44"', {"dvi_g[0]": "44", "dvi_g[1]": "45"}),
        ("tang_nano_20k", '"88", "87"', '"88", "86"', {"btn[1]": "87"}),
        ("de10_lite", '"P1", "T1"', '"P1", "T3"', {"VGA_B[1]": "T1"}),
    ],
)
def test_a_wrong_board_is_noticed(name, right, wrong, found, tmp_path: Path):
    shutil.copytree(boards.HERE / name, tmp_path / name)
    path = tmp_path / name / boards.DESCRIPTION
    assert path.read_text().count(right) == 1
    path.write_text(path.read_text().replace(right, wrong))
    assert differences(load_board(tmp_path / name)) == found
