# SPDX-License-Identifier: MIT
"""The buses that the registers can be behind."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from raycaster.rtl.bus.apb_bridge import apb_bridge
from raycaster.rtl.bus.axi4lite_bridge import axi4lite_bridge
from raycaster.rtl.bus.wishbone_bridge import wishbone_bridge
from raycaster.rtl.common.interfaces import ApbPort, AvalonPort, Axi4LitePort, Interface, WishbonePort


@dataclass(frozen=True)
class Bus:
    """A bus.

    Attributes:
        port: the argument of `ray_caster_module`, and the prefix of its signals in Verilog.
        interface: makes that port, for a number of address bits.
        bridge: the block between it and Avalon-MM; None for Avalon-MM itself.
    """

    port: str
    interface: Callable[[int], Interface]
    bridge: Callable | None = None


BUSES: Mapping[str, Bus] = {
    "avalon": Bus("avs_s0", AvalonPort),
    "axi4lite": Bus("s_axi", Axi4LitePort, axi4lite_bridge),
    "wishbone": Bus("wb", WishbonePort, wishbone_bridge),
    "apb": Bus("s_apb", ApbPort, apb_bridge),
}
"""By what `Configuration.bus` may be."""
