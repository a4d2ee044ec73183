# SPDX-License-Identifier: MIT
"""Faults that the bench must notice: designs broken on purpose, each with its expected error."""

from __future__ import annotations

import contextlib
import re

import pytest
from conftest import BUILD, SMALL_SCENE, Bench

from raycaster.configuration import configure
from raycaster.sim.simulator import SimulationError, convert

CONFIGURATION = configure(screen="tiny", units=8, rectangles=3)

WRAPPER = """
{header}
    wire [7:0] r;
    wire hs, vs, blank_n, pixel_clk;
    sound_module inner (
        .vga_r(r), .vga_hs(hs), .vga_vs(vs), .vga_blank_n(blank_n), .vga_clk(pixel_clk), .*
    );
    // The bench counts cycles by these.
    wire progress_start_screen = inner.progress_start_screen, progress_busy = inner.progress_busy;
    // The pixel's position in the picture, from 1, for faults in one place only.
    integer x, y;
    always @(negedge pixel_clk) #1 begin
        x <= blank_n ? x + 1 : 0;
        y <= !vs ? 0 : blank_n && x == 0 ? y + 1 : y;
    end
    // One pixel late: sampled in the middle of a pixel, output at its end.
    reg hs_taken, hs_late, vs_taken, vs_late;
    reg [7:0] r_taken, r_late;
    always @(posedge pixel_clk) {{hs_taken, vs_taken, r_taken}} <= {{hs, vs, r}};
    always @(negedge pixel_clk) {{hs_late, vs_late, r_late}} <= {{hs_taken, vs_taken, r_taken}};
    assign vga_hs = {hs};
    assign vga_vs = {vs};
    assign vga_blank_n = {blank_n};
    assign vga_clk = {clk};
    assign vga_r = {r};
endmodule
"""
"""Module with the design's name and ports, and one fault at its video output."""

PINS = {"hs": "hs", "vs": "vs", "blank_n": "blank_n", "clk": "pixel_clk", "r": "r"}


@pytest.mark.slow_sets(quick=["no-hs", "one-bit-of-one-pixel", "sound"])
@pytest.mark.parametrize(
    ("pins", "complaint"),
    [
        pytest.param({}, None, id="sound"),
        pytest.param(
            {"r": "r ^ (x == 63 && y == 40)"}, "frame: 1 of 12288 pixels are wrong", id="one-bit-of-one-pixel"
        ),
        pytest.param({"r": "blank_n ? r_late : 8'd0"}, "pixels are wrong", id="picture-a-pixel-late"),
        pytest.param({"hs": "hs_late"}, "line 1, sample 159: VS is 1, expected 0", id="hs-a-pixel-late"),
        pytest.param({"vs": "vs_late"}, "VS is 1, expected 0", id="vs-a-pixel-late"),
        pytest.param({"hs": "hs || hs_late"}, "line 0, sample 15: HS is 1, expected 0", id="hs-a-pixel-short"),
        pytest.param({"hs": "hs && hs_late"}, "line 0, sample 16: HS is 0, expected 1", id="hs-a-pixel-long"),
        pytest.param({"hs": "!hs"}, "line 0, sample .*: .* is", id="hs-upside-down"),
        pytest.param({"vs": "!vs"}, "VS is 0, expected 1", id="vs-upside-down"),
        pytest.param({"blank_n": "blank_n && x != 1"}, "BLANK_N is 0, expected 1", id="blank-a-pixel-long"),
        pytest.param({"r": "blank_n ? r : 8'd1"}, "any colour in blanking is 1, expected 0", id="grey-blanking"),
        pytest.param({"r": "x == 5 ? 8'bx : r"}, "an output is neither 0 nor 1", id="unknown"),
        pytest.param({"clk": "!pixel_clk"}, "line 0, sample .*: HS is", id="wrong-clock-edge"),
        pytest.param({"r": "r_taken & {8{blank_n}}"}, "video data changed at .* rising edges", id="unstable"),
        pytest.param({"hs": "1'b1"}, "no leading edge of HS", id="no-hs"),
        pytest.param({"vs": "1'b1"}, "no leading edge of VS", id="no-vs"),
    ],
)
def test_is_noticed(bench: Bench, tmp_path, pins, complaint):
    """One fault at a time; without a fault, the wrapper changes nothing."""
    *parts, top = convert(CONFIGURATION, BUILD)
    text = top.read_text()
    [header] = re.findall(r"^module ray_caster_module \(.*?^\);", text, re.M | re.S)
    sound, wrapper = tmp_path / "sound.v", tmp_path / "wrapper.v"
    sound.write_text(text.replace("module ray_caster_module", "module sound_module"))
    wrapper.write_text(WRAPPER.format(header=header, **PINS | pins))
    noticed = pytest.raises(SimulationError, match=complaint) if complaint else contextlib.nullcontext()
    with noticed:
        bench("sim.frame_bench", CONFIGURATION, "icarus", SMALL_SCENE, verilog=[*parts, sound, wrapper])
