# SPDX-License-Identifier: MIT
"""The bridges from other buses to the registers' Avalon-MM port."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from raycaster.rtl.bus.apb_bridge import ApbPort, apb_bridge
from raycaster.rtl.bus.axi4lite_bridge import Axi4LitePort, axi4lite_bridge
from raycaster.rtl.bus.wishbone_bridge import WishbonePort, wishbone_bridge
from raycaster.rtl.common.interfaces import BusPort


class Bridge(NamedTuple):
    """The bridge of a bus other than Avalon-MM: its port's constructor, given a word address width, and its block."""

    interface: Callable[[int], BusPort]
    block: Callable


BRIDGES: Mapping[str, Bridge] = {
    "axi4lite": Bridge(Axi4LitePort, axi4lite_bridge),
    "wishbone": Bridge(WishbonePort, wishbone_bridge),
    "apb": Bridge(ApbPort, apb_bridge),
}
"""Bridges by bus name."""
