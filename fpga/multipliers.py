# SPDX-License-Identifier: MIT
"""Registers that an ECP5's multipliers have of their own, for the products that Yosys puts into the fabric's."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

MULTIPLIER, REGISTER = "MULT18X18D", "TRELLIS_FF"


def register_products(netlist: Path) -> int:
    """Let each multiplier hold its product itself, where all that reads it is a register without enable or reset.

    Yosys does not infer these registers; nextpnr knows their timing. The way from the factors' registers to the
    product's is then one way through the fabric instead of two.

    Args:
        netlist: JSON, as Yosys writes it; replaced.

    Returns:
        How many multipliers do.
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
    # What a port of the module shows has a reader that is no register.
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
    """Let a multiplier's product come a cycle of this net later; enable and reset are tied, not left open."""
    multiplier["parameters"]["REG_OUTPUT_CLK"] = "CLK0"
    for port, net in {"CLK0": clock, "CE0": "1", "RST0": "0"}.items():
        multiplier["port_directions"][port] = "input"
        multiplier["connections"][port] = [net]


def _nets(cell: Mapping[str, Any], direction: str) -> Iterator[tuple[str, int | str]]:
    for port, nets in cell["connections"].items():
        if cell["port_directions"][port] == direction:
            yield from ((port, net) for net in nets)


def _is_plain(cell: Mapping[str, Any]) -> bool:
    """A register that takes a value at each edge, and starts with 0."""
    parameters = {name: value.strip() for name, value in cell["parameters"].items()}
    always = {"CEMUX": "1", "CLKMUX": "CLK", "REGSET": "RESET"}
    return (
        cell["type"] == REGISTER
        and all(parameters[name] == value for name, value in always.items())
        and cell["connections"]["LSR"] == ["0"]
    )
