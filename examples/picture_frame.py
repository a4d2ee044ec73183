# SPDX-License-Identifier: MIT
"""RayCaster inside a design of one's own: a picture frame, which needs no processor.

After reset a small Avalon-MM host writes one scene from a ROM, and the monitor shows it. Run it to get Verilog:

    python examples/picture_frame.py scenes/boxes.toml build/picture_frame
"""

from __future__ import annotations

import sys
from pathlib import Path

from myhdl import Signal, always_comb, always_seq, block, intbv

from raycaster.configuration import Configuration, configure
from raycaster.convert.elaboration import elaboration
from raycaster.convert.hierarchy import convert_hierarchy
from raycaster.program import scene_words
from raycaster.registers import address_bits
from raycaster.rtl.common.ties import tied, unconnected
from raycaster.rtl.system.ray_caster_module import ModulePorts, ray_caster_module
from raycaster.scene import Scene, load_scene


@block
def scene_writer(clk, reset, address, write, writedata, waitrequest, words):
    """Write each (address, word) of `words` once, in order, waiting where the agent asks for it; then rest."""
    count = len(words)
    addresses = tuple(word[0] for word in words)
    contents = tuple(word[1] for word in words)
    position = Signal(intbv(0, min=0, max=count + 1))
    rom_index = Signal(intbv(0, min=0, max=count))

    # The ROM ends where the scene does.
    @always_comb
    def index():
        rom_index.next = 0
        if position < count:
            rom_index.next = position

    # Which register.
    @always_comb
    def read_address():
        address.next = addresses[int(rom_index)]

    # What goes into it.
    @always_comb
    def read_word():
        writedata.next = contents[int(rom_index)]

    # Until all is written.
    @always_comb
    def request():
        write.next = position < count

    # The next one, when this one was taken.
    @always_seq(clk.posedge, reset=reset)
    def advance():
        if position < count and not waitrequest:
            position.next = position + 1

    return index, read_address, read_word, request, advance


@block
def picture_frame(
    clk,
    reset,
    vga_r,
    vga_g,
    vga_b,
    vga_hs,
    vga_vs,
    vga_blank_n,
    vga_sync_n,
    vga_clk,
    scene: Scene,
    config: Configuration,
):
    """Show one scene for ever. The vga signals are those of ray_caster_module."""
    words = tuple(scene_words(scene, config.table, min(scene.reflections, config.reflections)))
    address = Signal(intbv(0)[address_bits(config.table) :])
    write, waitrequest = Signal(bool(0)), Signal(bool(0))
    writedata = Signal(intbv(0)[32:])
    whole_word, never = tied(0b1111, 4), tied(0, 1)

    writer = scene_writer(clk, reset, address, write, writedata, waitrequest, words)
    tracer = ray_caster_module(
        clk, reset, address, never, write, writedata, whole_word, unconnected(32), unconnected(1), waitrequest,
        unconnected(1), vga_r, vga_g, vga_b, vga_hs, vga_vs, vga_blank_n, vga_sync_n, vga_clk, config,
    )  # fmt: skip

    return writer, tracer


def ports(config: Configuration) -> dict[str, Signal]:
    """Signals for the ports of picture_frame: those of ray_caster_module without the bus."""
    return {
        name: signal
        for name, signal in ModulePorts(config).all().items()
        if name in ("clk", "reset") or name.startswith("vga_")
    }


def convert(scene: Scene, config: Configuration, directory: Path) -> list[Path]:
    """Write the design as Verilog, one file a module, the top last."""
    directory.mkdir(parents=True, exist_ok=True)
    with elaboration():
        top = picture_frame(**ports(config), scene=scene, config=config)
    return [module.path for module in convert_hierarchy(top, directory, "// {module}")]


if __name__ == "__main__":
    for path in convert(load_scene(sys.argv[1]), configure(), Path(sys.argv[2])):
        print(path)
