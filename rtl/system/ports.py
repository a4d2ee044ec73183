# SPDX-License-Identifier: MIT
"""Signals for every port of a top, by the names of its arguments: `top(**its_ports(config), config=config)`."""

from typing import Any

from myhdl import ResetSignal

from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.memory_map import BUTTON_NAMES
from raycaster.registers import address_bits
from raycaster.rtl.common.interfaces import ApbPort, AvalonPort, Axi4LitePort, Vga, WishbonePort, vga_of
from raycaster.rtl.common.widths import bit, unsigned
from raycaster.rtl.dvi.tmds_encoder import SYMBOL_BITS
from raycaster.rtl.system.scene_player import BUTTONS

BUS_PORTS = {
    "avalon": ("avs_s0", AvalonPort),
    "axi4lite": ("s_axi", Axi4LitePort),
    "wishbone": ("wb", WishbonePort),
    "apb": ("s_apb", ApbPort),
}
"""By what `Configuration.bus` may be: the argument of ray_caster_module, and what makes it for so many address bits."""


def module_ports(config: Configuration) -> dict[str, Any]:
    """Those of ray_caster_module; Verilog has vga_* and, of its bus, avs_s0_*, s_axi_*, wb_* or s_apb_*."""
    name, interface = BUS_PORTS[config.bus]
    ports = {"clk": bit(), "reset": ResetSignal(0, active=1, isasync=False), "avs_s0": None}
    ports |= {name: interface(address_bits(config.table))}
    return ports | {"irq": bit(), "vga": vga_of(config)}


def system_ports(config: Configuration) -> dict[str, Any]:
    """Those of ray_caster_system."""
    return {"clk": bit(), "ready": bit(), "buttons": unsigned(len(BUTTONS)), "vga": vga_of(config)}


def processor_ports(config: Configuration) -> dict[str, Any]:
    """Those of processor_system."""
    return system_ports(config) | {"buttons": unsigned(len(BUTTON_NAMES)), "uart_tx": bit()}


def dvi_ports() -> dict[str, Any]:
    """Those of dvi_encoder."""
    symbols = {channel: unsigned(SYMBOL_BITS) for channel in ("blue", "green", "red")}
    return {"clk": bit(), "ready": bit(), "pixel_end": bit(), "vga": Vga(CHANNEL_BITS), **symbols, "pixel": bit()}
