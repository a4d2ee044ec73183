# SPDX-License-Identifier: MIT
"""The ray tracer in a LiteX SoC: a VexRiscv runs the C driver, and the display matches the golden model.

The boards' pins and clocks are compared with LiteX-Boards, which others use on the same boards.
"""

from __future__ import annotations

import json
import re
from importlib import import_module

import numpy as np
import pytest
from conftest import BUILD, ROOT, run_tool
from litex.build.generic_platform import GenericPlatform, Pins, Subsignal
from litex.soc.cores.video import video_data_layout
from litex.soc.integration.export import get_csr_json
from litex.soc.integration.soc_core import SoCCore
from migen.genlib.io import CRG

from raycaster.configuration import configure
from raycaster.convert.litex import add_ray_caster
from raycaster.errors import UserError
from raycaster.fpga.board import Board, OpenBoard, find_board
from raycaster.golden.exact import ExactModel
from raycaster.golden.picture import shown
from raycaster.registers import register_map
from raycaster.scene import load_scene
from raycaster.sim.simulator import build_program

SCENE = load_scene(ROOT / "docs" / "three_rectangles.toml")
"""Scene drawn by examples/litex_soc.c."""

VIDEO = ("video", 0, Subsignal("valid", Pins(1)), *(Subsignal(name, Pins(width)) for name, width in video_data_layout))

# The second interrupt begins a frame with the whole scene, which ends at the next vertical sync.
BENCH = """
`timescale 1ns/1ns
module soc_bench;
reg clk = 0, reset = 1;
wire [COLOUR_BITS-1:0] r, g, b;
wire [7:0] leds, video_r, video_g, video_b;
wire hs, vs, blank_n, vga_clk, valid, hsync, vsync, de;
integer frames = 0, wrong_syncs = 0;
soc soc (.clk(clk), .reset(reset), .leds(leds), .vga_r(r), .vga_g(g), .vga_b(b), .vga_hs(hs), .vga_vs(vs),
    .vga_blank_n(blank_n), .vga_sync_n(), .vga_clk(vga_clk), .video_valid(valid), .video_hsync(hsync),
    .video_vsync(vsync), .video_de(de), .video_r(video_r), .video_g(video_g), .video_b(video_b));
always #10 clk = ~clk;
initial #100 reset = 0;
always @(negedge vs) if (!reset) begin
    frames = frames + 1;
    $display("frame %0d, wrong syncs %0d", leds, wrong_syncs);
    if (leds >= 2 || frames == 10) $finish;
end
always @(posedge vga_clk) if (!reset && blank_n) $display("pins %h", {r, g, b});
always @(negedge clk) if (!reset && valid) begin
    if (de) $display("stream %h", {video_r, video_g, video_b});
    if (hsync == hs || vsync == vs) wrong_syncs = wrong_syncs + 1;
end
endmodule
"""


def pixels(text: str, name: str, shape: tuple[int, int], colour_bits: int) -> np.ndarray:
    """Read a frame's pixels, each a word of three channels."""
    words = np.array([int(word, 16) for word in re.findall(rf"^{name} (\w+)$", text, re.MULTILINE)]).reshape(shape)
    channels = [words >> shift * colour_bits & (1 << colour_bits) - 1 for shift in (2, 1, 0)]
    return np.stack(channels, axis=-1) << 8 - colour_bits


@pytest.mark.slow_sets("axi4lite")
@pytest.mark.parametrize(
    "options",
    [{"bus": "wishbone", "engine": "exact"}, {"bus": "axi4lite", "engine": "beam", "colour_bits": 5}],
    ids=["wishbone", "axi4lite"],
)
def test_a_frame_is_golden(options, tmp_path, monkeypatch):
    """VGA pins and video stream show the golden picture; the driver finds the registers and receives interrupts."""
    monkeypatch.syspath_prepend(ROOT / "examples")
    example = import_module("litex_soc")
    config = configure(screen="tiny", rectangles=3, **options)
    soc = example.make_soc(config, tmp_path, [VIDEO])
    video = soc.platform.request("video")
    source = soc.ray_caster.source
    soc.comb += [getattr(video, name).eq(getattr(source, name)) for name in ("valid", *dict(video_data_layout))]
    files = example.write(soc, tmp_path)
    # LiteX's comments contain the time; without them a built model is found again.
    files[-1].write_text(re.sub(r"^//.*\n", "", files[-1].read_text(), flags=re.MULTILINE))
    bench = tmp_path / "soc_bench.v"
    bench.write_text(BENCH.replace("COLOUR_BITS", str(config.colour_bits)))
    # The processor's registers have no reset; random initial values reveal reads before the first write.
    flags = ("--x-assign", "unique", "--x-initial", "unique", "-Wno-lint", "-Wno-style")
    command = build_program(f"litex-{config.name}", bench.stem, [*files, bench], build=BUILD, flags=flags)
    done = run_tool(tmp_path, *command, "+verilator+rand+reset+2")
    *_, last, end, _ = re.split(r"^frame (.*)\n", done.stdout, flags=re.MULTILINE)
    assert end == "2, wrong syncs 0", done.stdout
    screen = config.screen_geometry
    shape = screen.vertical.visible, screen.horizontal.visible
    expected = shown(ExactModel().render(SCENE, screen), config)
    assert len(np.unique(expected.reshape(-1, 3), axis=0)) == 1 + len(SCENE.rect)
    assert np.array_equal(pixels(last, "pins", shape, config.colour_bits), expected)
    assert np.array_equal(pixels(last, "stream", shape, 8), expected)


@pytest.mark.slow_sets("wishbone")
@pytest.mark.parametrize(("bus", "standard"), [("wishbone", "axi-lite"), ("axi4lite", "wishbone")])
def test_the_map_is_that_of_the_registers(bus, standard, tmp_path):
    """A SoC without a processor and with another bus standard has each register at its offset in the map."""
    platform = GenericPlatform("none", [("clk", 0, Pins(1))])
    soc = SoCCore(platform, 50e6, bus_standard=standard, cpu_type=None, with_uart=False, with_timer=False)
    soc.crg = CRG(platform.request("clk"))
    config = configure(screen="tiny", rectangles=3, bus=bus)
    add_ray_caster(soc, config, tmp_path / "verilog", name="tracer", origin=0x8000_0000)
    soc.finalize()
    exported = json.loads(get_csr_json(soc.csr_regions, soc.constants, soc.mem_regions))
    assert exported["memories"]["tracer"] == {"base": 0x8000_0000, "size": 128, "type": "io"}
    expected = {
        "tracer_" + re.sub(r"\[(\d+)\]\.", r"_\1_", name) + "_offset": 4 * register.address
        for name, register in register_map(config.rectangles).items()
    }
    assert {name: value for name, value in exported["constants"].items() if name.endswith("_offset")} == expected


@pytest.mark.parametrize(
    ("options", "clock", "complaint"),
    [
        ({"bus": "apb"}, 50e6, "bus: LiteX takes wishbone or axi4lite, not apb"),
        ({"bus": "wishbone"}, 48e6, r"clock: seed-tiny.* needs 50 MHz, and the SoC has 48"),
        ({"bus": "wishbone", "engine": "beam", "pixels": 2}, 12.5e6, "pixels: LiteX's video has 1 per clock, not 2"),
    ],
)
def test_bad_options_get_one_line(options, clock, complaint, tmp_path):
    soc = SoCCore(GenericPlatform("none", []), clock, cpu_type=None, with_uart=False, with_timer=False)
    with pytest.raises(UserError, match=rf"^{complaint}$"):
        add_ray_caster(soc, configure(screen="tiny", rectangles=3, **options), tmp_path / "verilog")
    assert not any(tmp_path.iterdir())


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
