# SPDX-License-Identifier: MIT
"""The example of a design of one's own does what it says: converted as a user would, it shows the scene."""

import importlib.util
import subprocess
from pathlib import Path

import numpy as np

from raycaster.configuration import configure
from raycaster.golden import seed_engine
from raycaster.scene import load_scene

ROOT = Path(__file__).parents[2]

BENCH = """
module example_bench;
reg clk = 0, reset = 1;
wire [7:0] r, g, b;
wire blank_n, vga_clk;
integer file, pixels;
picture_frame dut (.clk(clk), .reset(reset), .vga_r(r), .vga_g(g), .vga_b(b), .vga_hs(), .vga_vs(),
    .vga_blank_n(blank_n), .vga_sync_n(), .vga_clk(vga_clk));
always #10 clk = ~clk;
initial begin
    file = $fopen("pixels.txt", "w");
    pixels = 0;
    #100 reset = 0;
end
always @(posedge vga_clk) if (!reset && blank_n) begin
    $fdisplay(file, "%h", {r, g, b});
    pixels = pixels + 1;
    if (pixels == PIXELS) $finish;
end
endmodule
"""


def test_picture_frame(tmp_path):
    spec = importlib.util.spec_from_file_location("picture_frame", ROOT / "examples" / "picture_frame.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    config = configure(screen="tiny", units=4, rectangles=3)
    screen = config.screen_geometry
    scene = load_scene(ROOT / "scenes" / "boxes.toml")
    scene = scene.model_copy(update={"rect": scene.rect[:3]})
    files = example.convert(scene, config, tmp_path)
    visible = screen.vertical.visible, screen.horizontal.visible
    (tmp_path / "example_bench.v").write_text(BENCH.replace("PIXELS", str(visible[0] * visible[1])))
    for command in (
        ["iverilog", "-g2005", "-s", "example_bench", "-o", "bench", "example_bench.v", *(file.name for file in files)],
        ["vvp", "-n", "bench"],
    ):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    words = np.array([int(line, 16) for line in (tmp_path / "pixels.txt").read_text().split()]).reshape(visible)
    shown = np.stack([words >> 16, words >> 8 & 255, words & 255], axis=-1)
    expected = seed_engine.render(scene, screen)
    doubled = expected.repeat(screen.doubling, axis=0).repeat(screen.doubling, axis=1)
    assert np.array_equal(shown, doubled)
