# SPDX-License-Identifier: MIT
"""Buses that can give access to the registers."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Bus:
    """Names and timing of a bus.

    A cycle count runs from the first cycle in which the full request is on an idle bus to the one with the response.

    Attributes:
        title: name on pages.
        port: argument of `ray_caster_module`, and prefix of the signals in Verilog.
        unit: address unit, words or bytes.
        write: cycles per write.
        read: cycles per read.
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
"""Buses by their name in `Configuration.bus`. The registers are on the first; the others have a bridge to it."""

OWN, *BRIDGED = BUSES
