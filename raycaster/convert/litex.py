# SPDX-License-Identifier: MIT
"""The ray tracer as a LiteX module: `add_ray_caster` puts it into a SoC with any processor and board."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from litex.build.generic_platform import GenericPlatform
from litex.gen import ClockSignal, Instance, LiteXModule, ResetSignal, Signal
from litex.soc.cores.video import video_data_layout
from litex.soc.integration.soc import SoC, SoCRegion
from litex.soc.interconnect import stream, wishbone
from litex.soc.interconnect.axi import AXILiteInterface
from litex.soc.interconnect.csr_eventmanager import EventManager, EventSourceLevel

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.convert.take_home import PREFIX, TOP
from raycaster.convert.write import write_verilog
from raycaster.errors import UserError
from raycaster.registers import address_bits, register_map
from raycaster.rtl.common.interfaces import Vga

BUSES = ("wishbone", "axi4lite")
"""Supported values of `Configuration.bus`; LiteX adapts both to the SoC's bus."""

CLOCK_TOLERANCE = 0.01
"""Allowed relative difference between the SoC's clock and the design's clock; PLLs seldom meet a standard exactly."""


class RayCaster(LiteXModule):
    """ray_caster_module in the clock domain `sys`.

    Args:
        platform: gets the Verilog files.
        config: the design.
        directory: directory for these files; replaced as a whole.

    Attributes:
        bus: LiteX interface of the registers, Wishbone with word addresses or AXI-Lite.
        size: size of the registers in bytes, a power of two.
        ev: LiteX's event manager; its event `frame` is the level of the ray tracer's own interrupt.
        vga: signals for a DAC, by the port's name without `vga_`: `r`, `g`, `b`, `hs`, `vs`, `blank_n`, `sync_n`,
            `clk`.
        source: the video as LiteX's stream, for its PHYs and cores: a beat is a pixel, in the clock in which it is
            valid. There is no back-pressure. Colours have 8 bits, and both syncs are active high.

    Raises:
        UserError: the design's bus is not in `BUSES`, or it has more than one pixel per clock.
    """

    comb: Any
    specials: Any
    """Migen creates both on first access."""

    def __init__(self, platform: GenericPlatform, config: Configuration, directory: Path):
        if config.bus not in BUSES:
            raise UserError(f"bus: LiteX takes {' or '.join(BUSES)}, not {config.bus}")
        if config.pixels != 1:
            raise UserError(f"pixels: LiteX's video has 1 per clock, not {config.pixels}")
        for path in write_verilog(config, directory, PREFIX):
            platform.add_source(str(path), "verilog")
        words = address_bits(*config.map)
        self.size = 4 << words
        self.ev = EventManager()
        self.ev.frame = EventSourceLevel(description="A frame has begun; cleared in the ray tracer's irq_pending.")
        self.ev.finalize()
        self.vga = {name: Signal(len(port), name=f"vga_{name}") for name, port in vars(Vga(config.port_bits)).items()}
        ports: dict[str, Any] = {f"o_vga_{name}": signal for name, signal in self.vga.items()}
        self.specials += Instance(
            TOP,
            i_clk=ClockSignal(),
            i_reset=ResetSignal(),
            o_irq=self.ev.frame.trigger,
            **(self._wishbone(words) if config.bus == "wishbone" else self._axi4lite(words)),
            **ports,
        )
        self._stream(config)

    def _wishbone(self, words: int) -> dict[str, Signal]:
        """Return the ports of a Wishbone bus."""
        bus: Any = wishbone.Interface(data_width=32, address_width=32, addressing="word")
        self.bus = bus
        self.comb += bus.err.eq(0)
        inputs = {f"i_wb_{name}": getattr(bus, name) for name in ("cyc", "stb", "we", "sel", "dat_w")}
        return inputs | {"i_wb_adr": bus.adr[:words], "o_wb_ack": bus.ack, "o_wb_dat_r": bus.dat_r}

    def _axi4lite(self, words: int) -> dict[str, Signal]:
        """Return the ports of an AXI4-Lite bus."""
        self.bus = bus = AXILiteInterface(data_width=32, address_width=32)
        fields = {"aw": ["addr"], "w": ["data", "strb"], "b": ["resp"], "ar": ["addr"], "r": ["data", "resp"]}
        ports = {}
        for name, channel in ((name, getattr(bus, name)) for name in fields):
            given, answered = ("i", "o") if name in ("aw", "w", "ar") else ("o", "i")
            for field in ("valid", *fields[name]):
                ports[f"{given}_s_axi_{name}{field}"] = getattr(channel, field)
            ports[f"{answered}_s_axi_{name}ready"] = channel.ready
        return ports | {f"i_s_axi_{name}addr": getattr(bus, name).addr[: words + 2] for name in ("aw", "ar")}

    def _stream(self, config: Configuration) -> None:
        self.source = source = stream.Endpoint(video_data_layout)
        screen, vga = config.screen_geometry, self.vga
        self.comb += [
            # Data is taken at the rising edge of vga_clk, which is clk inverted or halved.
            source.valid.eq(1 if screen.clocks_per_pixel == 1 else ~vga["clk"]),
            source.hsync.eq(vga["hs"] == int(screen.horizontal.active_high)),
            source.vsync.eq(vga["vs"] == int(screen.vertical.active_high)),
            source.de.eq(vga["blank_n"]),
            *(getattr(source, name)[CHANNEL_BITS - config.colour_bits :].eq(vga[name]) for name in "rgb"),
        ]


def add_ray_caster(
    soc: SoC, config: Configuration, directory: Path, *, name: str = "ray_caster", origin: int | None = None
) -> RayCaster:
    """Put a ray tracer into a SoC, with its registers, its interrupt, and constants for software.

    The SoC's headers and its `csr.json` then have the region, as `RAY_CASTER_BASE`, the interrupt's number, and each
    register's offset in the region, such as `RAY_CASTER_CONTROL_OFFSET`.

    Args:
        soc: the SoC; it runs at the design's clock frequency.
        config: the design.
        directory: directory for its Verilog; replaced as a whole.
        name: name of the module in the SoC.
        origin: byte address of the registers, or None to let LiteX choose one that the processor does not cache;
            required without a processor.

    Returns:
        The module, `soc.<name>`; the caller connects its video.

    Raises:
        UserError: `RayCaster` refuses the design, or the SoC has another clock.
    """
    wanted = config.screen_geometry.clock_hz
    if abs(soc.sys_clk_freq - wanted) > CLOCK_TOLERANCE * wanted:
        raise UserError(f"clock: {config.name} needs {wanted / 1e6:g} MHz, and the SoC has {soc.sys_clk_freq / 1e6:g}")
    module = RayCaster(soc.platform, config, directory)
    soc.add_module(name, module)
    soc.bus.add_slave(name, module.bus, SoCRegion(origin=origin, size=module.size, mode="rw", cached=False))
    if soc.irq.enabled:
        soc.irq.add(name, use_loc_if_exists=True)
    for path, register in register_map(*config.map).items():
        constant = re.sub(r"\W+", "_", path).upper()
        soc.add_constant(f"{name}_{constant}_OFFSET", 4 * register.address)
    return module
