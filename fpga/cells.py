# SPDX-License-Identifier: MIT
"""Count a design's cells for three families of chips, with Yosys, before placement."""

from __future__ import annotations

import json
import math
import operator
import re
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raycaster.configuration import Configuration
from raycaster.convert.take_home import TOP
from raycaster.convert.write import write_verilog
from raycaster.hdl.verilog_style import without_power_up
from raycaster.runs.tools import run_yosys

HARD_MULTIPLIER = Path(__file__).with_name("hard_multiplier.v")


@dataclass(frozen=True)
class Area:
    """Cells of a design or of one of its modules."""

    tables: int
    """Look-up tables: with 4 inputs on the ECP5, including two per carry cell and those used as RAM, and on the Cyclone
    IV; with up to 6 inputs on the Cyclone V."""

    registers: int
    elements: int
    """Logic elements of a table and a register each: tables, plus registers that share no element with a table. On the
    ECP5, the tables. On the Cyclone V, a lower bound on the adaptive logic modules, which have two tables of up to 5
    inputs, or one of 6, and four registers."""

    multipliers: int
    """Hard multipliers: 18-bit ones on the ECP5, 9-bit ones on the Cyclones, where a wider one counts as several."""

    memories: int
    """RAM blocks."""

    def __add__(self, other: Area) -> Area:
        return Area(*map(operator.add, vars(self).values(), vars(other).values()))

    def __sub__(self, other: Area) -> Area:
        return Area(*map(operator.sub, vars(self).values(), vars(other).values()))

    def __mul__(self, times: int) -> Area:
        return Area(*(times * count for count in vars(self).values()))

    def texts(self) -> list[str]:
        """Format the counts for a table."""
        return [f"{count:,}" for count in vars(self).values()]


@dataclass(frozen=True)
class Family:
    """A family of chips, with its Yosys commands.

    Attributes:
        name: name in options.
        title: name for people.
        element: name of its logic elements.
        synthesis: Yosys command for synthesis.
        prepare: Yosys commands between reading the design and synthesis.
        count: returns the area of a module, given its cells in a JSON netlist.
        power_up: False if Yosys's block RAM has no initial contents, so that memories that are written begin unknown.
    """

    name: str
    title: str
    element: str
    synthesis: str
    prepare: Sequence[str]
    count: Callable[[Mapping[str, Any]], Area]
    power_up: bool = True


_ECP5_TABLES = {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 4}
_ALUTS = {f"MISTRAL_ALUT{inputs}": inputs for inputs in range(2, 7)} | {"MISTRAL_NOT": 1, "MISTRAL_ALUT_ARITH": 4}


def _kinds(cells: Mapping[str, Any]) -> Counter[str]:
    return Counter(cell["type"] for cell in cells.values())


def _nine_bit_multipliers(cells: Iterable[Mapping[str, Any]]) -> int:
    """Count the 9-bit multipliers that black boxes need: one for 9-bit factors, two for factors of up to 18 bits."""
    count = 0
    for cell in cells:
        widest = max(int(cell["parameters"][name], 2) for name in ("A_WIDTH", "B_WIDTH"))
        count += 1 if widest <= 9 else 2 * math.ceil(widest / 18) ** 2
    return count


def _fed_registers(cells: Mapping[str, Any], register: str, data: str, tables: Iterable[str], output: str) -> int:
    """Count the registers that share a logic element with the table that feeds them: at most one per table."""
    outputs = {cell["connections"][output][0] for cell in cells.values() if cell["type"] in set(tables)}
    fed = {cell["connections"][data][0] for cell in cells.values() if cell["type"] == register}
    return len(outputs & fed)


def _count_ecp5(cells: Mapping[str, Any]) -> Area:
    kinds = _kinds(cells)
    tables = sum(kinds[kind] * size for kind, size in _ECP5_TABLES.items())
    return Area(tables, kinds["TRELLIS_FF"], tables, kinds["MULT18X18D"], kinds["DP16KD"] + kinds["PDPW16KD"])


def _count_cyclone_iv(cells: Mapping[str, Any]) -> Area:
    kinds = _kinds(cells)
    tables, registers = kinds["cycloneive_lcell_comb"], kinds["dffeas"]
    fed = _fed_registers(cells, "dffeas", "d", ["cycloneive_lcell_comb"], "combout")
    multipliers = _nine_bit_multipliers(cell for cell in cells.values() if cell["type"] == "hard_multiplier")
    return Area(tables, registers, tables + registers - fed, multipliers, kinds["altsyncram"])


def _count_cyclone_v(cells: Mapping[str, Any]) -> Area:
    kinds = _kinds(cells)
    tables = sum(kinds[kind] for kind in _ALUTS)
    six = kinds["MISTRAL_ALUT6"]
    modules = max(six + math.ceil((tables - six) / 2), math.ceil(kinds["MISTRAL_FF"] / 4))
    multipliers = kinds["MISTRAL_MUL9X9"] + 2 * kinds["MISTRAL_MUL18X18"] + 3 * kinds["MISTRAL_MUL27X27"]
    return Area(tables, kinds["MISTRAL_FF"], modules, multipliers, kinds["MISTRAL_M10K"])


FAMILIES = {
    family.name: family
    for family in (
        Family("ecp5", "ECP5", "LUT4", "synth_ecp5", (), _count_ecp5),
        Family(
            "cycloneive",
            "Cyclone IV E",
            "logic elements",
            "synth_intel -family cycloneive",
            # Otherwise multipliers become logic, some 225 logic elements each.
            (
                f"read_verilog {HARD_MULTIPLIER.name}",
                "proc",
                "opt",
                "wreduce",
                "opt_clean",
                "chtype -set hard_multiplier t:$mul",
            ),
            _count_cyclone_iv,
            power_up=False,
        ),
        Family(
            "cyclonev",
            "Cyclone V",
            "ALMs, at least",
            "synth_intel_alm -family cyclonev",
            (),
            _count_cyclone_v,
            power_up=False,
        ),
    )
}


def measure(config: Configuration, family: Family, directory: Path, top: str = TOP) -> Area:
    """Count the cells of the flattened design, or of one of its modules alone, such as one ray unit.

    Args:
        config: configuration of the design.
        family: one of `FAMILIES`.
        directory: directory, which is replaced; keeps Yosys's input and output.
        top: name of the module.

    Raises:
        UserError: Yosys is missing, or reported an error.
    """
    return family.count(_netlist(config, family, directory, top)[top]["cells"])


def measure_modules(config: Configuration, family: Family, directory: Path) -> dict[str, tuple[int, Area]]:
    """Count by module, deepest last: its instances, and the cells of one instance without its submodules."""

    found: dict[str, int] = {}
    modules = _netlist(config, family, directory, TOP, "-noflatten")

    def visit(name: str, times: int) -> None:
        found[name] = found.pop(name, 0) + times
        for inside, count in _kinds(modules[name]["cells"]).items():
            if inside in modules and "blackbox" not in modules[inside]["attributes"]:
                visit(inside, times * count)

    visit(TOP, 1)
    return {_sized(name): (times, family.count(modules[name]["cells"])) for name, times in found.items()}


def _sized(name: str) -> str:
    """Return Yosys's name for a module, but `by_axis_9` for `$paramod\\by_axis\\width=s32'...01001`."""
    if parts := re.fullmatch(r"\$paramod\\(\w+)\\\w+=s32'([01]+)", name):
        return f"{parts[1]}_{int(parts[2], 2)}"
    return name


def _netlist(
    config: Configuration, family: Family, directory: Path, top: str, *options: str
) -> Mapping[str, dict[str, Any]]:
    """Synthesise a design in a directory, whose contents are replaced; return the netlist's modules by name."""
    sources = [path.name for path in write_verilog(config, directory) if path.suffix == ".v"]
    for path in map(directory.joinpath, sources) if not family.power_up else ():
        path.write_text(without_power_up(path.read_text()))
    shutil.copy(HARD_MULTIPLIER, directory)
    script = [
        *(f"read_verilog {source}" for source in sources),
        f"hierarchy -check -top {top}",
        *family.prepare,
        " ".join([family.synthesis, f"-top {top}", *options]),
        "delete t:$scopeinfo",
        "write_json netlist.json",
    ]
    run_yosys(directory, "synthesis", script)
    return json.loads((directory / "netlist.json").read_text())["modules"]
