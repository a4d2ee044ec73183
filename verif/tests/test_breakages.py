# SPDX-License-Identifier: MIT
"""Faults that the bench must notice: designs broken on purpose, each with its expected error."""

from __future__ import annotations

import contextlib
import re

import numpy as np
import pytest
from conftest import BUILD, SMALL_SCENE, Bench

from raycaster.design.decide import configure
from raycaster.golden.picture import WRONG
from raycaster.sim.monitor import PULSE, Line, VideoError, decode_frame
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
            {"r": "r ^ (x == 63 && y == 40)"},
            "frame: 1 of 12,288 pixels are wrong; .* column 62 of line 39, is #",
            id="one-bit-of-one-pixel",
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
def test_is_noticed(bench: Bench, tmp_path, output, pins, complaint):
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
    # A whole frame that departs from the standard is shown.
    assert (output / "sync.png").exists() == bool(re.search("HS is|is [01], expected|neither|.* is$", complaint or ""))


@pytest.mark.parametrize("number, name, rule", [
    (0, "HS", "0 in samples 0 to 15 and 1 in all others"), (1, "VS", "0 in lines 0 to 1 and 1 in all others"),
    (2, "BLANK_N", "1 in the picture only"), (3, "SYNC_N", "0"), (5, "any colour in blanking", "0"),
])  # fmt: skip
def test_a_wrong_sample_is_shown(number, name, rule):
    """The message has its place, the extent of the fault and the rule; the picture has it in pink, a pulse in blue."""
    screen, bits = CONFIGURATION.screen_geometry, 4 + 3 * 8
    columns, rows = np.arange(screen.horizontal.total), np.arange(screen.vertical.total)[:, None]
    samples = np.zeros((len(rows), len(columns), bits), dtype=np.uint8)
    seen = (columns >= 24) & (columns < 152) & (rows >= 6) & (rows < 102)
    samples[..., 0], samples[..., 1], samples[..., 2] = columns >= 16, rows >= 2, seen

    def frame(short: int = -1) -> list[Line]:
        texts = ("".join(map(str, line[::-1].flatten())) for line in samples)
        return [Line(text, len(columns) - (row == short), 0) for row, text in enumerate(texts)]

    decode_frame(frame(), screen, 8)
    with pytest.raises(VideoError, match="line 3: 159 pixels between leading edges of HS, expected 160") as raised:
        decode_frame(frame(short=3), screen, 8)
    assert np.argwhere((raised.value.picture == WRONG).all(axis=-1)).tolist() == [[3, 159]]
    samples[4:6, 20:23, number] ^= 1
    with pytest.raises(VideoError) as raised:
        decode_frame(frame(), screen, 8)
    level = samples[4, 20, number]
    assert str(raised.value) == (
        f"line 4, sample 20: {name} is {level}, expected {1 - level}; 6 samples are wrong, in lines 4 to 5 and samples "
        f"20 to 22 (counted from the leading edges of VS and HS); {name} must be {rule}"
    )
    picture = raised.value.picture
    assert np.argwhere((picture == WRONG).all(axis=-1)).tolist() == [[i, j] for i in (4, 5) for j in (20, 21, 22)]
    assert picture[50, 0].tolist() == picture[0, 80].tolist() == list(PULSE)
