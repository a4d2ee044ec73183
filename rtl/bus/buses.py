# SPDX-License-Identifier: MIT
"""The bridges from other buses to the registers' Avalon-MM port."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from raycaster.configuration import Configuration
from raycaster.rtl.bus.apb_bridge import ApbPort, apb_bridge
from raycaster.rtl.bus.axi4lite_bridge import Axi4LitePort, axi4lite_bridge
from raycaster.rtl.bus.uart_bridge import UartPort, longest_frame, uart_bridge
from raycaster.rtl.bus.wishbone_bridge import WishbonePort, wishbone_bridge
from raycaster.rtl.common.interfaces import BusPort


class Bridge(NamedTuple):
    """The bridge of a bus other than Avalon-MM.

    Attributes:
        interface: its port's constructor, given a word address width.
        block: its block.
        parameters: returns the block's parameters for a design.
    """

    interface: Callable[[int], BusPort]
    block: Callable
    parameters: Callable[[Configuration], Mapping[str, Any]] = lambda config: {}


def _serial(config: Configuration) -> Mapping[str, Any]:
    clock_hz = config.screen_geometry.clock_hz
    return {"clock_hz": clock_hz, "baud": config.baud, "places": longest_frame(config)}


BRIDGES: Mapping[str, Bridge] = {
    "axi4lite": Bridge(Axi4LitePort, axi4lite_bridge),
    "wishbone": Bridge(WishbonePort, wishbone_bridge),
    "apb": Bridge(ApbPort, apb_bridge),
    "uart": Bridge(UartPort, uart_bridge, _serial),
}
"""Bridges by bus name."""
