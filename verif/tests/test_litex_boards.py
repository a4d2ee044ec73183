# SPDX-License-Identifier: MIT
"""Compare the boards' pins and clocks with LiteX-Boards, which others use on the same boards."""

from __future__ import annotations

from importlib import import_module

import pytest
from litex.build.generic_platform import Pins, Subsignal

from raycaster.fpga.board import Board, OpenBoard, find_board

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
VGA = {"VGA_R": "vga.r", "VGA_G": "vga.g", "VGA_B": "vga.b", "VGA_HS": "vga.hsync_n", "VGA_VS": "vga.vsync_n"}
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


@pytest.mark.parametrize("name", PLATFORMS)
def test_pins_are_the_same(name):
    """Each pin of the signals above and the clock's frequency are those of LiteX-Boards, or differ for a reason."""
    board, (theirs, mhz) = find_board(name, Board), pins_of_litex(name)
    ours, found = {}, {}
    for signal, known in NAMES[name].items():
        pins = [pin for one in ([known] if isinstance(known, str) else known) for pin in theirs[one]]
        assert len(pins) >= len(board.bits(signal)) > 0, signal
        ours |= board.bits(signal)
        # LiteX-Boards may list further clock pins, which are separate signals here.
        found |= dict(zip(board.bits(signal), pins, strict=False))
    assert found == ours | OTHER.get(name, {})
    assert not isinstance(board, OpenBoard) or board.clock_mhz == pytest.approx(mhz, rel=0, abs=1e-6)
