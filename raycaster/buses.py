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
        write: cycles per write; 0 if the line's rate decides.
        read: cycles per read; 0 likewise.
        serial: True for a serial line, whose rate is `Configuration.baud`.
    """

    title: str
    port: str
    unit: str
    write: int
    read: int
    serial: bool = False


BUSES: Mapping[str, Bus] = {
    "avalon": Bus(title="Avalon-MM", port="avs_s0", unit="words", write=1, read=3),
    "axi4lite": Bus(title="AXI4-Lite", port="s_axi", unit="bytes", write=3, read=3),
    "wishbone": Bus(title="Wishbone B4, classic", port="wb", unit="words", write=1, read=3),
    "apb": Bus(title="APB4", port="s_apb", unit="bytes", write=2, read=3),
    "uart": Bus(title="serial line", port="uart", unit="words", write=0, read=0, serial=True),
}
"""Buses by their name in `Configuration.bus`. The registers are on the first; the others have a bridge to it."""

OWN, *BRIDGED = BUSES

USUAL_BAUD = 1_000_000
"""Baud rate of a serial line unless another one is chosen."""

BYTE_BITS = 9.5
"""Bits from the beginning of a byte on a serial line to the middle of its stop bit."""

RATE_ERROR = 0.015
"""Part of a byte's time by which a bit may be sampled too early or too late."""


def most_baud(clock_hz: int) -> int:
    """Return the highest baud rate for a clock, which sends and samples bits up to a cycle too early or too late."""
    return int(clock_hz * BYTE_BITS * RATE_ERROR)
