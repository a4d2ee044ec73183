# SPDX-License-Identifier: MIT
"""The bridges from the buses that the registers can be behind."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from raycaster.rtl.bus.apb_bridge import ApbPort, apb_bridge
from raycaster.rtl.bus.axi4lite_bridge import Axi4LitePort, axi4lite_bridge
from raycaster.rtl.bus.wishbone_bridge import WishbonePort, wishbone_bridge
from raycaster.rtl.common.interfaces import BusPort


class Bridge(NamedTuple):
    """A bus that is not Avalon-MM: what makes its port, of the width of a word's address, and the block between."""

    interface: Callable[[int], BusPort]
    block: Callable


BRIDGES: Mapping[str, Bridge] = {
    "axi4lite": Bridge(Axi4LitePort, axi4lite_bridge),
    "wishbone": Bridge(WishbonePort, wishbone_bridge),
    "apb": Bridge(ApbPort, apb_bridge),
}
"""By the bus's name."""
