# SPDX-License-Identifier: MIT
"""Move the registers of products from the fabric into an ECP5's multipliers, which Yosys does not do."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

MULTIPLIER, REGISTER, FACTOR_BITS = "MULT18X18D", "TRELLIS_FF", 18


def register_products(netlist: Path) -> int:
    """Move registers that have neither enable nor reset from the fabric into the multipliers beside them.

    A product that only a register reads goes into the output register. Otherwise, as with a part of a long product that
    is still to be added, each factor that comes from a register goes into an input register. Yosys does not infer these
    registers; nextpnr knows their timing. The path from the registers of the factors to that of the product then
    crosses the fabric once instead of twice.

    Args:
        netlist: JSON netlist from Yosys; replaced.

    Returns:
        The number of multipliers that now have an output register.
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
    plain = {name for name, cell in cells.items() if cell["type"] == REGISTER and _is_plain(cell)}
    registered, others = 0, []
    for multiplier in [cell for cell in cells.values() if cell["type"] == MULTIPLIER]:
        product = {port: readers[net] for port, net in _nets(multiplier, "output") if readers[net]}
        read = [reader for those in product.values() for reader in those]
        names = [name for name, port in read if port == "DI" and name in plain]
        clocks = {cells[name]["connections"]["CLK"][0] for name in names}
        if len(names) == len(read) == len(product) and len(clocks) == 1:
            plain.difference_update(names)
            for port, name in zip(product, names, strict=True):
                multiplier["connections"][port] = cells.pop(name)["connections"]["Q"]
            connect_register(multiplier, clocks.pop())
            registered += 1
        else:
            others.append(multiplier)
    _register_factors(others, cells, {cells[name]["connections"]["Q"][0]: name for name in plain}, readers)
    return registered


def _register_factors(
    multipliers: Sequence[dict[str, Any]], cells: dict[str, Any], registers: Mapping[int | str, str],
    readers: Mapping[int | str, Sequence[tuple[str, str]]],
) -> None:  # fmt: skip
    """Move the registers of whole factors; those that others read as well stay, too.

    Args:
        multipliers: multipliers without an output register.
        cells: all cells of the module, by name.
        registers: names of the plain registers, by the net that they drive.
        readers: names and ports of the cells that read each net.
    """
    taken: Counter[int | str] = Counter()
    for multiplier in multipliers:
        connections = multiplier["connections"]
        for factor in "AB":
            ports = [f"{factor}{place}" for place in range(FACTOR_BITS)]
            nets = {port: connections[port][0] for port in ports if connections[port] != ["0"]}
            held = {port: cells[registers[net]]["connections"] for port, net in nets.items() if net in registers}
            clocks = {register["CLK"][0] for register in held.values()}
            if len(held) == len(nets) and len(clocks) == 1:
                connections |= {port: register["DI"] for port, register in held.items()}
                connect_register(multiplier, clocks.pop(), f"INPUT{factor}")
                taken.update(nets.values())
    for net, count in taken.items():
        if count == len(readers[net]):
            del cells[registers[net]]


def connect_register(multiplier: dict[str, Any], clock: int, place: str = "OUTPUT") -> None:
    """Delay a product, or the factor at INPUTA or INPUTB, by a cycle of this clock net, without enable and reset."""
    multiplier["parameters"][f"REG_{place}_CLK"] = "CLK0"
    for port, net in {"CLK0": clock, "CE0": "1", "RST0": "0"}.items():
        multiplier["port_directions"][port] = "input"
        multiplier["connections"][port] = [net]


def _nets(cell: Mapping[str, Any], direction: str) -> Iterator[tuple[str, int | str]]:
    for port, nets in cell["connections"].items():
        if cell["port_directions"][port] == direction:
            yield from ((port, net) for net in nets)


def _is_plain(cell: Mapping[str, Any]) -> bool:
    """Return True if a register captures a value at each edge, and starts at 0."""
    parameters = {name: value.strip() for name, value in cell["parameters"].items()}
    always = {"CEMUX": "1", "CLKMUX": "CLK", "REGSET": "RESET"}
    return all(parameters[name] == value for name, value in always.items()) and cell["connections"]["LSR"] == ["0"]
