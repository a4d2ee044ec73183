# SPDX-License-Identifier: MIT
"""RayCaster in a LiteX SoC: a VexRiscv draws with the C driver, on no board in particular.

To get the SoC's Verilog, with its memory's contents and LiteX's headers, run in a clone of the project:

    pip install '.[litex,play]'
    python examples/litex_soc.py build/litex_soc
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.design.options import run_command
from raycaster.memory_map import MEMORY_BYTES
from raycaster.rtl.common.interfaces import Vga
from raycaster.sw.firmware import DRIVER, START, build_firmware

try:
    from litex.build.generic_platform import GenericPlatform, Pins, Subsignal
    from litex.soc.cores.gpio import GPIOOut
    from litex.soc.integration.export import get_csr_header, get_mem_header, get_soc_header
    from litex.soc.integration.soc_core import SoCCore
    from migen.genlib.io import CRG

    from raycaster.convert.litex import add_ray_caster
except ModuleNotFoundError as missing:
    raise SystemExit(
        f"error: {missing.name} is not installed; in a clone of the project, run: pip install '.[litex,play]'"
    ) from None

PROGRAM = Path(__file__).with_suffix(".c")


def pins(config: Configuration) -> list[tuple]:
    """The SoC's ports; a board's platform would assign pins to them."""
    vga = (Subsignal(name, Pins(len(port))) for name, port in vars(Vga(config.port_bits)).items())
    return [("clk", 0, Pins(1)), ("reset", 0, Pins(1)), ("leds", 0, Pins(8)), ("vga", 0, *vga)]


class RayCasterSoC(SoCCore):
    """A VexRiscv, a memory for its program, LEDs, and the ray tracer with a VGA output."""

    comb: Any
    """Migen creates it on first access."""

    def __init__(self, platform: GenericPlatform, config: Configuration, directory: Path):
        clk: Any = platform.request("clk")
        reset: Any = platform.request("reset")
        self.crg = CRG(clk, reset)
        super().__init__(
            platform,
            clk_freq=config.screen_geometry.clock_hz,
            cpu_variant="lite",
            integrated_rom_size=MEMORY_BYTES,
            integrated_rom_mode="rwx",
            integrated_sram_size=0,
            with_uart=False,
            with_timer=False,
        )
        self.leds = GPIOOut(platform.request("leds"))
        ray_caster = add_ray_caster(self, config, directory)
        vga = platform.request("vga")
        self.comb += [getattr(vga, name).eq(signal) for name, signal in ray_caster.vga.items()]


def make_soc(config: Configuration, directory: Path, more_pins: Sequence[tuple] = ()) -> RayCasterSoC:
    """Make the SoC, with the ray tracer's Verilog in `directory`."""
    platform = GenericPlatform("none", [*pins(config), *more_pins], name="soc")
    return RayCasterSoC(platform, config, directory / "ray_caster")


def write(soc: RayCasterSoC, directory: Path) -> list[Path]:
    """Write LiteX's headers, `soc_rom.init` for the memory, and Verilog; return the Verilog files, the top last."""
    soc.finalize()
    headers = {
        "mem.h": get_mem_header(soc.bus.regions),
        "soc.h": get_soc_header(soc.constants, with_access_functions=False),
        "csr.h": get_csr_header(
            soc.csr.regions, soc.constants, soc.bus.regions["csr"].origin, with_access_functions=False
        ),
    }
    for name, text in headers.items():
        (directory / name).write_text(text)
    firmware = build_firmware((directory / "firmware").absolute(), (START, PROGRAM, DRIVER), [directory.absolute()])
    soc.init_rom("rom", [int(word, 16) for word in firmware.words.read_text().split()])
    top = directory / "soc.v"
    output = soc.platform.get_verilog(soc, name=top.stem)
    for name, text in (output.data_files | {top.name: output.main_source}).items():
        (directory / name).write_text(text)
    return [*(Path(source) for source, *_ in soc.platform.sources), top]


def main() -> None:
    """Write a SoC, and print the paths of its Verilog."""
    parser = argparse.ArgumentParser(description="Write the Verilog of a SoC with the ray tracer.")
    parser.add_argument("directory", type=Path, help="output: Verilog, LiteX's headers and the memory's contents")
    output = parser.parse_args().directory
    for path in write(make_soc(configure(bus="wishbone", engine="exact"), output), output):
        print(path)


if __name__ == "__main__":
    run_command(main)
