# SPDX-License-Identifier: MIT
"""The ray tracer as a module of LiteX: `add_ray_caster` puts it into a SoC, of any processor and board."""

from __future__ import annotations

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
from raycaster.rtl.common.interfaces import vga_of

BUSES = ("wishbone", "axi4lite")
"""What `Configuration.bus` may be here; LiteX adapts both to the SoC's own."""

CLOCK_TOLERANCE = 0.01
"""Of the SoC's clock, as a part of the design's: a PLL seldom has exactly what a monitor's standard says."""


class RayCaster(LiteXModule):
    """ray_caster_module in the clock domain `sys`.

    Args:
        platform: gets the Verilog files.
        config: the design.
        directory: for these files; replaced as a whole.

    Attributes:
        bus: the registers; an interface of LiteX, of Wishbone with word addresses or of AXI-Lite.
        size: bytes that they take up, a power of two.
        ev: LiteX's event manager; its event `frame` is the level of the ray tracer's own interrupt.
        vga: by the port's name without `vga_`, the signals for a DAC: `r`, `g`, `b`, `hs`, `vs`, `blank_n`, `sync_n`,
            `clk`.
        source: the same as LiteX's video stream, for its PHYs and cores: a beat is a pixel, in the clock in which it is
            valid. It cannot wait. Colours have 8 bits, and both syncs are active high.

    Raises:
        UserError: the design has another bus than LiteX does, or more than one pixel a clock.
    """

    comb: Any
    specials: Any
    """Migen makes both when they are asked for."""

    def __init__(self, platform: GenericPlatform, config: Configuration, directory: Path):
        if config.bus not in BUSES:
            raise UserError(f"bus: LiteX takes {' or '.join(BUSES)}, not {config.bus}")
        if config.pixels != 1:
            raise UserError(f"pixels: LiteX's video has 1 a clock, not {config.pixels}")
        for path in write_verilog(config, directory, PREFIX):
            platform.add_source(str(path), "verilog")
        words = address_bits(config.table)
        self.size = 4 << words
        self.ev = EventManager()
        self.ev.frame = EventSourceLevel(description="A frame has begun; cleared in the ray tracer's irq_pending.")
        self.ev.finalize()
        self.vga = {name: Signal(len(port), name=f"vga_{name}") for name, port in vars(vga_of(config)).items()}
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
        """The ports of that bus."""
        bus: Any = wishbone.Interface(data_width=32, address_width=32, addressing="word")
        self.bus = bus
        self.comb += bus.err.eq(0)
        inputs = {f"i_wb_{name}": getattr(bus, name) for name in ("cyc", "stb", "we", "sel", "dat_w")}
        return inputs | {"i_wb_adr": bus.adr[:words], "o_wb_ack": bus.ack, "o_wb_dat_r": bus.dat_r}

    def _axi4lite(self, words: int) -> dict[str, Signal]:
        """The same of the other."""
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
    """Put a ray tracer into a SoC: its registers on the bus, its interrupt, its names among the SoC's.

    The SoC's headers and its `csr.json` then have the region, as `RAY_CASTER_BASE`, the interrupt's number, and as
    constants where each register is in the region, such as `RAY_CASTER_CONTROL_OFFSET`.

    Args:
        soc: its clock is the design's.
        config: the design.
        directory: for its Verilog; replaced as a whole.
        name: of the module in the SoC.
        origin: byte address of the registers, or None for where there is room for what a processor must not cache;
            without a processor it is to be given.

    Returns:
        The module, `soc.<name>`, whose video is to be connected.

    Raises:
        UserError: the design is none for `RayCaster`, or the SoC's clock is another.
    """
    wanted = config.screen_geometry.clock_hz
    if abs(soc.sys_clk_freq - wanted) > CLOCK_TOLERANCE * wanted:
        raise UserError(f"clock: {config.name} needs {wanted / 1e6:g} MHz, and the SoC has {soc.sys_clk_freq / 1e6:g}")
    module = RayCaster(soc.platform, config, directory)
    soc.add_module(name, module)
    soc.bus.add_slave(name, module.bus, SoCRegion(origin=origin, size=module.size, mode="rw", cached=False))
    if soc.irq.enabled:
        soc.irq.add(name, use_loc_if_exists=True)
    for path, register in register_map(config.table).items():
        constant = path.replace("].", "_").replace("[", "_").upper()
        soc.add_constant(f"{name}_{constant}_OFFSET", 4 * register.address)
    return module
