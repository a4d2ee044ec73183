# SPDX-License-Identifier: MIT
"""The buses that the registers may be behind."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Bus:
    """A bus.

    A cycle count runs from the first cycle in which the full request is on an idle bus to the one with the response.

    Attributes:
        title: its name on pages.
        port: the argument of `ray_caster_module`, and the prefix of its signals in Verilog.
        unit: what an address counts, words or bytes.
        write: cycles of a write.
        read: cycles of a read.
    """

    title: str
    port: str
    unit: str
    write: int
    read: int


BUSES: Mapping[str, Bus] = {
    "avalon": Bus(title="Avalon-MM", port="avs_s0", unit="words", write=1, read=3),
    "axi4lite": Bus(title="AXI4-Lite", port="s_axi", unit="bytes", write=3, read=3),
    "wishbone": Bus(title="Wishbone B4, classic", port="wb", unit="words", write=1, read=3),
    "apb": Bus(title="APB4", port="s_apb", unit="bytes", write=2, read=3),
}
"""By the name in `Configuration.bus`; the first is the bus of the registers, the others have a bridge to it."""

OWN, *BRIDGED = BUSES
