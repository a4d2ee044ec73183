# SPDX-License-Identifier: MIT
"""Signals for every port of a top module, by argument name: `top(**its_ports(config), config=config)`."""

from typing import Any

from raycaster.buses import BUSES
from raycaster.configuration import CHANNEL_BITS, Configuration
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.memory_map import BUTTON_NAMES
from raycaster.registers import address_bits
from raycaster.rtl.bus.buses import BRIDGES
from raycaster.rtl.bus.uart_bridge import UartPort
from raycaster.rtl.common.interfaces import AvalonPort, Vga
from raycaster.rtl.dvi.tmds_encoder import SYMBOL_BITS
from raycaster.rtl.system.scene_player import BUTTONS


def module_ports(config: Configuration) -> dict[str, Any]:
    """Return the ports of ray_caster_module; in Verilog they become vga_* and, for the bus, avs_s0_* or similar."""
    interface = BRIDGES[config.bus].interface if config.bus in BRIDGES else AvalonPort
    ports = {"clk": bit(), "reset": reset_signal(), "avs_s0": None}
    ports |= {BUSES[config.bus].port: interface(address_bits(*config.map))}
    return ports | {"irq": bit(), "vga": Vga(config.port_bits)}


def scene_system_ports(config: Configuration) -> dict[str, Any]:
    """Return the ports of scene_system."""
    return {"clk": bit(), "ready": bit(), "buttons": unsigned(len(BUTTONS)), "vga": Vga(config.port_bits)}


def serial_system_ports(config: Configuration) -> dict[str, Any]:
    """Return the ports of serial_system."""
    return {"clk": bit(), "ready": bit(), "uart": UartPort(address_bits(*config.map)), "vga": Vga(config.port_bits)}


def system_ports(config: Configuration) -> dict[str, Any]:
    """Return the ports of ray_caster_system."""
    return scene_system_ports(config) | {"buttons": unsigned(len(BUTTON_NAMES)), "uart_tx": bit()}


def dvi_ports() -> dict[str, Any]:
    """Return the ports of dvi_encoder."""
    symbols = {channel: unsigned(SYMBOL_BITS) for channel in ("blue", "green", "red")}
    return {"clk": bit(), "pixel_end": bit(), "vga": Vga(CHANNEL_BITS), **symbols, "pixel": bit()}
