# SPDX-License-Identifier: MIT
"""RayCaster in your own MyHDL design: a picture frame that needs no processor.

After reset a small Avalon-MM host writes one scene from a ROM, and the monitor shows it. To get Verilog, run:

    python examples/picture_frame.py raycaster/scenes/boxes.toml build/picture_frame
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from myhdl import Signal, always_comb, always_seq, block, instances, intbv

from raycaster.configuration import Configuration
from raycaster.convert.vocabulary import VOCABULARY
from raycaster.design.decide import configure
from raycaster.design.options import run_command
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.signals import tied, unconnected
from raycaster.program import scene_words
from raycaster.registers import address_bits
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.system.ports import module_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.scene import Scene, load_scene


@block
def scene_writer(clk, reset, avm_m0, words):
    """Avalon-MM host: write each (address, word) of `words` once, in order, waiting when the agent requests it."""
    count = len(words)
    addresses = tuple(word[0] for word in words)
    contents = tuple(word[1] for word in words)
    position = Signal(intbv(0, min=0, max=count + 1))
    rom_index = Signal(intbv(0, min=0, max=count))

    # The ROM has no word after the scene.
    @always_comb
    def index():
        rom_index.next = 0
        if position < count:
            rom_index.next = position

    @always_comb
    def read_address():
        avm_m0.address.next = addresses[int(rom_index)]

    @always_comb
    def read_word():
        avm_m0.writedata.next = contents[int(rom_index)]

    @always_comb
    def request():
        avm_m0.write.next = position < count

    @always_seq(clk.posedge, reset=reset)
    def advance():
        if position < count and not avm_m0.waitrequest:
            position.next = position + 1

    return instances()


@block
def picture_frame(clk, reset, vga, scene: Scene, config: Configuration):
    """Show one scene forever. vga is the port of ray_caster_module."""
    words = tuple(scene_words(scene, config, min(scene.reflections, config.most_reflections)))
    bus = AvalonPort(address_bits(config.table))
    bus.read, bus.byteenable = tied(0, bus.read), tied(0b1111, bus.byteenable)
    bus.readdata, bus.readdatavalid = unconnected(bus.readdata), unconnected(bus.readdatavalid)

    writer = scene_writer(clk, reset, avm_m0=bus, words=words)
    tracer = ray_caster_module(clk, reset, avs_s0=bus, irq=unconnected(1), vga=vga, config=config)

    return writer, tracer


def ports(config: Configuration) -> dict[str, Any]:
    """Signals for the ports of picture_frame: those of ray_caster_module without the bus."""
    signals = module_ports(config)
    return {name: signals[name] for name in ("clk", "reset", "vga")}


def convert(scene: Scene, config: Configuration, directory: Path) -> list[Path]:
    """Write the design as Verilog, one file per module, the top last."""
    directory.mkdir(parents=True, exist_ok=True)
    with elaboration():
        top = picture_frame(**ports(config), scene=scene, config=config)
    return [module.path for module in convert_hierarchy(top, directory, "// {module}", vocabulary=VOCABULARY)]


def main() -> None:
    """Write the Verilog of a scene file, and print the paths."""
    parser = argparse.ArgumentParser(description="Write the Verilog of a picture frame for one scene.")
    parser.add_argument("scene", type=Path, help="scene file, such as examples/two_boxes.toml")
    parser.add_argument("directory", type=Path, help="directory for the Verilog")
    arguments = parser.parse_args()
    for path in convert(load_scene(arguments.scene), configure(), arguments.directory):
        print(path)


if __name__ == "__main__":
    run_command(main)
