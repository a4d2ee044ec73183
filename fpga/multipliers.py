# SPDX-License-Identifier: MIT
"""Move the registers of products from the fabric into an ECP5's multipliers, which Yosys does not do."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

MULTIPLIER, REGISTER = "MULT18X18D", "TRELLIS_FF"


def register_products(netlist: Path) -> int:
    """Use a multiplier's own output register if its product goes only into a register without enable or reset.

    Yosys does not infer these registers; nextpnr knows their timing. The path from the registers of the factors to that
    of the product then crosses the fabric once instead of twice.

    Args:
        netlist: JSON netlist from Yosys; replaced.

    Returns:
        The number of multipliers that now have a register.
    """
    design = json.loads(netlist.read_text())
    registered = sum(_register_products(module) for module in design["modules"].values())
    netlist.write_text(json.dumps(design))
    return registered


def _register_products(module: Mapping[str, Any]) -> int:
    cells = module["cells"]
    readers = defaultdict(list)
    for name, cell in cells.items():
        for port, net in _nets(cell, "input"):
            readers[net].append((name, port))
    # A port of the module is a reader that is not a register.
    for port in module["ports"].values():
        for net in port["bits"]:
            readers[net].append(("", ""))
    registered = 0
    for multiplier in [cell for cell in cells.values() if cell["type"] == MULTIPLIER]:
        product = {port: readers[net] for port, net in _nets(multiplier, "output") if readers[net]}
        read = [reader for those in product.values() for reader in those]
        names = [name for name, port in read if port == "DI" and _is_plain(cells[name])]
        clocks = {cells[name]["connections"]["CLK"][0] for name in names}
        if len(names) == len(read) == len(product) and len(clocks) == 1:
            for port, name in zip(product, names, strict=True):
                multiplier["connections"][port] = cells.pop(name)["connections"]["Q"]
            connect_register(multiplier, clocks.pop())
            registered += 1
    return registered


def connect_register(multiplier: dict[str, Any], clock: int) -> None:
    """Delay a multiplier's product by one cycle of this clock net; enable and reset are tied off, not left open."""
    multiplier["parameters"]["REG_OUTPUT_CLK"] = "CLK0"
    for port, net in {"CLK0": clock, "CE0": "1", "RST0": "0"}.items():
        multiplier["port_directions"][port] = "input"
        multiplier["connections"][port] = [net]


def _nets(cell: Mapping[str, Any], direction: str) -> Iterator[tuple[str, int | str]]:
    for port, nets in cell["connections"].items():
        if cell["port_directions"][port] == direction:
            yield from ((port, net) for net in nets)


def _is_plain(cell: Mapping[str, Any]) -> bool:
    """Return True if a cell is a register that captures a value at each edge, and starts at 0."""
    parameters = {name: value.strip() for name, value in cell["parameters"].items()}
    always = {"CEMUX": "1", "CLKMUX": "CLK", "REGSET": "RESET"}
    return (
        cell["type"] == REGISTER
        and all(parameters[name] == value for name, value in always.items())
        and cell["connections"]["LSR"] == ["0"]
    )
